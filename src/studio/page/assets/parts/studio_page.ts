// SPDX-License-Identifier: Apache-2.0
import type {Member, Tab} from '../model/store';
import {Gallery} from './gallery';
import {HeightView} from './height_view';
import {HelpDialog} from './help_dialog';
import {NoticeBar} from './notice_bar';
import {Part, h} from './part';
import {PictureView} from './picture_view';
import {PlanView} from './plan_view';
import {RenderDialog} from './render_dialog';
import {SideBar} from './side_bar';
import {TimeBar} from './time_bar';
import {ToolBar} from './tool_bar';

const TABS: Tab[] = ['flyers', 'light', 'camera', 'text'];

// The whole page, and the keys that work anywhere on it.
export class StudioPage extends Part {
  protected readonly watches: Member[] = [];
  private picture = new PictureView();
  private time = new TimeBar();

  protected build(): void {
    this.append(
        new ToolBar(), new NoticeBar(),
        h('main', {}, this.picture, this.time, h('div', {class: 'views'}, new PlanView(), new HeightView())),
        new SideBar(), new Gallery(), new RenderDialog(), new HelpDialog());
    window.addEventListener('keydown', (event) => this.key(event));
  }

  protected update(): void {}

  private key(event: KeyboardEvent): void {
    const {studio} = this;
    const isControl = event.ctrlKey || event.metaKey;
    const commands: Record<string, () => void> = {
      s: () => void studio.save(),
      z: () => void (event.shiftKey ? studio.redo() : studio.undo()),
      y: () => void studio.redo()
    };
    const command = isControl && !event.altKey ? commands[event.key.toLowerCase()] : undefined;
    if (command) {
      event.preventDefault();
      if (event.target instanceof HTMLInputElement) event.target.blur();  // takes what is being typed first
      command();
      return;
    }
    if (isControl || event.altKey || this.now.dialog || isTyping(event.target)) return;
    if (event.target instanceof Element && event.target.matches('button, summary') &&
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
    const isRange = event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement;
    const tabs = Object.fromEntries(TABS.map((tab, k) => [String(k + 1), () => put({tab})]));
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
      n: () => put({dialog: 'gallery', addsAt: null, replaces: null}),
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
      Delete: () => studio.removeMoment(),
      Backspace: () => studio.removeMoment(),
      Escape: () => (now.moment !== null ? put({moment: null}) : studio.select(null)),
    };
  }
}

// Where a letter is a letter: fields of text and numbers.
function isTyping(target: EventTarget|null): boolean {
  return target instanceof HTMLTextAreaElement ||
      (target instanceof HTMLInputElement && !['range', 'checkbox', 'button'].includes(target.type));
}
