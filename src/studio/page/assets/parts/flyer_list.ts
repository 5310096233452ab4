// SPDX-License-Identifier: Apache-2.0
import type {Path, Track} from '../model/contract';
import {type Flyer, describedView, flyersOf, isSame, trackOf} from '../model/flyers';
import type {Member} from '../model/store';
import {FlyerPanel} from './flyer_panel';
import {Keyed, Part, attribute, button, h, text} from './part';

// What a begun scene may have guessed, by the names of its tables and keys.
const GUESSED: [string, string][] = [
  ['lens', 'the lens'], ['camera.position_ned_m', 'the height'], ['camera.velocity_ned_mps', 'the own speed'],
  ['camera.attitude_yaw_pitch_roll_deg', 'the attitude']
];

// All that flies: one button each, with what the checks say of it, and below the chosen one its numbers.
export class FlyerList extends Part {
  protected readonly watches: Member[] = ['state', 'plan', 'selected', 'clip'];
  private add = button(
      'Add aircraft, birds, drones …', () => this.studio.store.put({dialog: 'gallery'}),
      {class: 'main', title: 'Add (N)'});
  private list = h('ul', {class: 'flyers'});
  private empty = h('p', {class: 'hint'}, 'Nothing flies yet. Add an aircraft, or double-click the picture.');
  private guesses =
      h('p', {class: 'hint', hidden: true}, h('span', {}),
        button('Camera', () => this.studio.store.put({tab: 'camera'}), {class: 'small'}));
  private general = h('ul', {class: 'checks'});
  private panel = new FlyerPanel();
  private items = new Keyed<Flyer, HTMLLIElement>(
      this.list, (flyer) => this.make(flyer), (element, flyer) => this.renew(element, flyer));

  protected build(): void {
    this.append(this.add, this.guesses, this.empty, this.list, this.general);
  }

  protected update(): void {
    const {state, plan, clip} = this.now;
    const flyers = state ? flyersOf(state.scene) : [];
    this.add.disabled = !clip;
    const guessed =
        GUESSED.filter(([key]) => /\bguess|no horizon/i.test(state?.notes[key] ?? '')).map(([, words]) => words);
    this.guesses.hidden = !guessed.length;
    text(this.guesses.firstElementChild!, `Guessed: ${guessed.join(', ')}. Sizes and distances are as good as that. `);
    this.empty.hidden = flyers.length > 0 || !clip;
    this.items.show(flyers.map((flyer) => ({key: JSON.stringify(flyer.path), item: flyer})));
    this.general.replaceChildren(...(plan?.warnings ?? []).map((line) => h('li', {}, line)));
    if (!flyers.some((flyer) => isSame(flyer.path, this.now.selected))) this.panel.remove();
  }

  private make(flyer: Flyer): HTMLLIElement {
    const item: HTMLLIElement =
        h('li', {'data-path': JSON.stringify(flyer.path), onblur: () => item.removeAttribute('tabindex')},
          h('button', {class: 'flyer', onclick: () => this.chosen(flyer, item)}, h('span', {class: 'id'}),
            h('span', {class: 'title'})),
          h('p', {class: 'hint in-view'}), h('ul', {class: 'checks'}));
    return item;
  }

  // A heading that a pointer pressed has let go of the focus; its item takes it, for Delete.
  private chosen(flyer: Flyer, item: HTMLLIElement): void {
    if (!item.contains(document.activeElement)) {
      item.tabIndex = -1;
      item.focus({preventScroll: true});
    }
    this.studio.select(isSame(this.now.selected, flyer.path) ? null : flyer.path);
  }

  private renew(element: HTMLLIElement, flyer: Flyer): void {
    const isSelected = isSame(this.now.selected, flyer.path);
    attribute(element, 'class', `colour-${flyer.colour}${isSelected ? ' selected' : ''}`);
    const [heading, inView, checks] = ['button', '.in-view', '.checks'].map((one) => element.querySelector(one)!);
    const {plan, clip} = this.now;
    attribute(heading, 'aria-expanded', String(isSelected));
    text(heading.children[0], flyer.id);
    text(heading.children[1], flyer.title);
    const track = trackOf(plan, flyer.path);
    text(inView, track && plan && clip ? describedView(track, plan, clip) : '');
    const lines = checksOf(track);
    if (checks.childElementCount !== lines.length || lines.some((line, k) => checks.children[k].textContent !== line))
      checks.replaceChildren(...lines.map((line) => h('li', {}, line)));
    // What is said of it comes and goes below the fields.
    if (isSelected && this.panel.parentElement !== element) inView.before(this.panel);
  }
}
customElements.define('studio-flyers', FlyerList);

// The flyer whose heading has the focus.
export function headedBy(target: EventTarget|null): Path|null {
  const item = target instanceof Element && target.matches('.flyers > li, button.flyer') ? target.closest('li') : null;
  return item ? JSON.parse(item.dataset.path!) : null;
}

// What the server says of a flyer, and whether it is seen at all.
function checksOf(track: Track|null): string[] {
  if (!track) return [];
  const isSeen = track.points.some((point) => point[5]) || track.checks.some((line) => line.includes('never'));
  return isSeen ? track.checks : [...track.checks, 'never in view'];
}
