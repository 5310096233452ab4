// SPDX-License-Identifier: Apache-2.0
import type {Track} from '../model/contract';
import {type Flyer, flyersOf, isSame, trackOf} from '../model/flyers';
import type {Member} from '../model/store';
import {FlyerPanel} from './flyer_panel';
import {Keyed, Part, attribute, h, text} from './part';

// All that flies: one button each, with what the checks say of it, and below the chosen one its numbers.
export class FlyerList extends Part {
  protected readonly watches: Member[] = ['state', 'plan', 'selected'];
  private list = h('ul', {class: 'flyers'});
  private empty = h('p', {class: 'hint'}, 'Nothing flies yet. Add an aircraft, or double-click the picture.');
  private general = h('ul', {class: 'checks'});
  private panel = new FlyerPanel();
  private items = new Keyed<Flyer, HTMLLIElement>(
      this.list, (flyer) => this.make(flyer), (element, flyer) => this.renew(element, flyer));

  protected build(): void {
    const add =
        h('button', {
          class: 'main',
          title: 'Add (N)',
          onclick: () => this.studio.store.put({dialog: 'gallery', addsAt: null, replaces: null})
        },
          'Add aircraft, birds, drones …');
    this.append(add, this.empty, this.list, this.general);
  }

  protected update(): void {
    const {state, plan} = this.now;
    const flyers = state ? flyersOf(state.scene) : [];
    this.empty.hidden = flyers.length > 0 || !state;
    this.items.show(flyers.map((flyer) => ({key: JSON.stringify(flyer.path), item: flyer})));
    this.general.replaceChildren(...(plan?.warnings ?? []).map((line) => h('li', {}, line)));
    if (!flyers.some((flyer) => isSame(flyer.path, this.now.selected))) this.panel.remove();
  }

  private make(flyer: Flyer): HTMLLIElement {
    return h(
        'li', {},
        h('button', {class: 'flyer', onclick: () => this.chosen(flyer)}, h('span', {class: 'swatch'}),
          h('span', {class: 'id'}), h('span', {class: 'title'})),
        h('ul', {class: 'checks'}));
  }

  private chosen(flyer: Flyer): void {
    this.studio.select(isSame(this.now.selected, flyer.path) ? null : flyer.path);
  }

  private renew(element: HTMLLIElement, flyer: Flyer): void {
    const isSelected = isSame(this.now.selected, flyer.path);
    attribute(element, 'class', `colour-${flyer.colour}${isSelected ? ' selected' : ''}`);
    const [button, checks] = [element.children[0], element.children[1]];
    attribute(button, 'aria-expanded', String(isSelected));
    text(button.children[1], flyer.id);
    text(button.children[2], flyer.title);
    const lines = checksOf(trackOf(this.now.plan, flyer.path));
    if (checks.childElementCount !== lines.length || lines.some((line, k) => checks.children[k].textContent !== line))
      checks.replaceChildren(...lines.map((line) => h('li', {}, line)));
    if (isSelected && this.panel.parentElement !== element) element.append(this.panel);
  }
}

// What the server says of a flyer, and whether it is seen at all.
function checksOf(track: Track|null): string[] {
  if (!track) return [];
  const isSeen = track.points.some((point) => point[5]) || track.checks.some((line) => line.includes('never'));
  return isSeen ? track.checks : [...track.checks, 'never in view'];
}
