// SPDX-License-Identifier: Apache-2.0
import {isSame} from '../model/flyers';
import type {Member} from '../model/store';
import {restored} from './fields';
import {headedBy} from './flyer_list';
import {Gallery} from './gallery';
import {HeightView} from './height_view';
import {HelpDialog} from './help_dialog';
import {NoticeBar} from './notice_bar';
import {Part, h} from './part';
import {PictureView} from './picture_view';
import {PlanView} from './plan_view';
import {RenderDialog} from './render_dialog';
import {SideBar, TABS} from './side_bar';
import {TimeBar} from './time_bar';
import {ToolBar} from './tool_bar';

// The whole page, and the keys that work anywhere on it.
export class StudioPage extends Part {
  protected readonly watches: Member[] = ['state', 'planProblem'];
  private picture = new PictureView();
  private time = new TimeBar();

  protected build(): void {
    this.append(
        new ToolBar(), new NoticeBar(),
        h('main', {}, this.picture, this.time, h('div', {class: 'views'}, new PlanView(), new HeightView())),
        new SideBar(), new Gallery(), new RenderDialog(), new HelpDialog());
    window.addEventListener('keydown', (event) => this.key(event));
    this.leaveKeysToPage();
  }

  // What the plan says is of an older text while the present one cannot be used.
  protected update(): void {
    this.classList.toggle('stale', Boolean(this.now.state?.problem ?? this.now.planProblem));
  }

  // A button that a pointer pressed does not keep the focus: Space would press it again.
  private leaveKeysToPage(): void {
    let isByPointer = false;
    const letGo = (event: Event, kinds: string) => {
      const pressed = event.target instanceof Element ? event.target.closest<HTMLElement>(kinds) : null;
      if (isByPointer && !pressed?.closest('dialog')) pressed?.blur();
    };
    for (const kind of ['pointerdown', 'keydown'])
      window.addEventListener(kind, () => {
        isByPointer = kind === 'pointerdown';
      }, true);
    window.addEventListener('click', (event) => letGo(event, 'button'), true);
    window.addEventListener('change', (event) => letGo(event, 'select, [type="checkbox"]'), true);
  }

  private key(event: KeyboardEvent): void {
    const {studio} = this;
    const isControl = event.ctrlKey || event.metaKey;
    const commands: Record<string, () => void> = {
      s: () => void studio.save(),
      z: () => void (event.shiftKey ? studio.redo() : studio.undo()),
      y: () => void studio.redo()
    };
    const letter = event.key.toLowerCase();
    const command = isControl && !event.altKey ? commands[letter] : undefined;
    if (command && (letter === 's' || !this.now.dialog)) {
      event.preventDefault();
      if (letter === 'z' && restored(event.target)) return;
      if (event.target instanceof HTMLInputElement) event.target.blur();  // takes what is being typed first
      command();
      return;
    }
    if (event.key === 'Escape' && !this.now.dialog && isField(event.target)) {
      restored(event.target);
      event.target.blur();
      return;
    }
    if (isControl || event.altKey || this.now.dialog || isTyping(event.target)) return;
    if (event.target instanceof Element && event.target.matches('button, select, [type="checkbox"]') &&
        (event.key === ' ' || event.key === 'Enter'))
      return;
    const action = this.actions(event)[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }

  private actions(event: KeyboardEvent): Record<string, () => void> {
    const {studio, now} = this;
    const step = event.shiftKey ? 10 : 1;
    const put = (values: Parameters<typeof studio.store.put>[0]) => studio.store.put(values);
    const isRange = isField(event.target) && !event.target.closest('.strip');
    const tabs = Object.fromEntries(TABS.map(([tab], k) => [String(k + 1), () => put({tab})]));
    const arrows: Record<string, () => void> = isRange ? {} : {
      ArrowLeft: () => studio.show(now.frame - step),
      ArrowRight: () => studio.show(now.frame + step),
      Home: () => studio.show(0),
      End: () => studio.show((now.clip?.frames ?? 1) - 1),
    };
    return {
      ...tabs,
      ...arrows,
      ' ': () => this.time.toggle(),
      '[': () => studio.goToMoment(-1),
      ']': () => studio.goToMoment(1),
      m: () => studio.addMoment(),
      n: () => now.clip && put({dialog: 'gallery'}),
      r: () => put({dialog: 'render'}),
      f: () => this.picture.fit(),
      a: () => this.picture.pan(-1, 0),
      d: () => this.picture.pan(1, 0),
      w: () => this.picture.pan(0, -1),
      s: () => this.picture.pan(0, 1),
      '+': () => this.picture.zoom(1.25),
      '=': () => this.picture.zoom(1.25),
      '-': () => this.picture.zoom(1 / 1.25),
      '?': () => put({dialog: 'help'}),
      Delete: () => this.removeAt(event.target),
      Backspace: () => this.removeAt(event.target),
      Escape: () => (now.moment !== null ? put({moment: null}) : studio.select(null)),
    };
  }

  // The flyer whose heading has the focus, or else the chosen moment.
  private removeAt(target: EventTarget|null): void {
    const {moment, selected} = this.now;
    const path = headedBy(target);
    if (path && !(moment !== null && isSame(path, selected)))
      this.studio.remove(path);
    else
      this.studio.removeMoment();
  }
}

const isField = (target: EventTarget|null): target is HTMLInputElement|HTMLSelectElement =>
    target instanceof HTMLInputElement || target instanceof HTMLSelectElement;

// Where a letter is a letter: fields of text and numbers.
function isTyping(target: EventTarget|null): boolean {
  return target instanceof HTMLTextAreaElement ||
      (target instanceof HTMLInputElement && !['range', 'checkbox', 'button'].includes(target.type));
}
