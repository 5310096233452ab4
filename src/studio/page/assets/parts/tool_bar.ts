// SPDX-License-Identifier: Apache-2.0
import type {Member} from '../model/store';
import {restored, tick} from './fields';
import {Part, attribute, button, h, text} from './part';
import type {PictureView} from './picture_view';

// The file and whether it is saved, undo and redo, what is laid over the picture, and rendering.
export class ToolBar extends Part {
  protected readonly watches: Member[] = [
    'file', 'state', 'pending', 'connected', 'showsAircraft', 'showsBoxes', 'showsHorizon', 'showsMotion', 'busy',
    'progress', 'tab'
  ];
  private gaveBack = false;  // a text that was refused: that is what is undone
  private file = h('span', {class: 'file'});
  private saved = h('span', {class: 'saved', role: 'status'});
  private undo =
      h('button', {
        title: 'Undo (Ctrl+Z)',
        onpointerdown:
            () => {
              this.gaveBack = restored(document.activeElement);
            },
        onclick:
            () => {
              if (!this.gaveBack) void this.studio.undo();
              this.gaveBack = false;
            }
      },
        'Undo');
  private redo = button('Redo', () => void this.studio.redo(), {title: 'Redo (Ctrl+Shift+Z)'});
  private save = button('Save', () => void this.studio.save(), {title: 'Save the scene file (Ctrl+S)'});
  private render =
      button('Render …', () => this.studio.store.put({dialog: 'render'}), {class: 'main', title: 'Render (R)'});
  private ticks =
      ([
        ['showsAircraft', 'Aircraft'], ['showsBoxes', 'Boxes'], ['showsHorizon', 'Horizon'], ['showsMotion', 'Motion']
      ] as const)
          .map(([key, words]) => ({key, ...tick(words, (isOn) => this.studio.store.put({[key]: isOn}))}));

  protected build(): void {
    const picture = () => document.querySelector<PictureView>('studio-picture')!;
    const zoom = [
      button('−', () => picture().zoom(1 / 1.25), {'aria-label': 'Zoom out', title: 'Zoom out (-)'}),
      button('Fit', () => picture().fit(), {title: 'Show the whole frame (F)'}),
      button('+', () => picture().zoom(1.25), {'aria-label': 'Zoom in', title: 'Zoom in (+)'})
    ];
    this.append(
        h('h1', {}, 'airtruth studio'), this.file, this.saved,
        h('span', {class: 'group'}, this.undo, this.redo, this.save),
        h('fieldset', {class: 'group', 'aria-label': 'Shown over the picture'},
          ...this.ticks.map((one) => one.element)),
        h('span', {class: 'group'}, ...zoom), h('span', {class: 'space'}), this.render,
        button(
            '?', () => this.studio.store.put({dialog: 'help'}),
            {'aria-label': 'Help', title: 'Keys and gestures (?)'}));
  }

  protected update(): void {
    const {state, file, pending, connected, busy, progress, tab} = this.now;
    const name = file.split('/').pop() ?? '';
    text(this.file, name);
    attribute(this.file, 'title', file);
    document.title = `${state && !state.saved ? '• ' : ''}${name || 'airtruth studio'}`;
    const isSaved = state?.saved && !pending;
    text(
        this.saved,
        !connected        ? 'no connection' :
            !state        ? '' :
            !isSaved      ? 'not saved' :
            state.problem ? 'has an error' :
                            'saved');
    this.saved.classList.toggle('open', Boolean(state && (!state.saved || state.problem)));
    this.undo.disabled = !connected || !state?.undo;
    this.redo.disabled = !connected || !state?.redo;
    this.save.disabled = !connected || !state || (state.saved && !state.changed_on_disk);
    for (const {key, input} of this.ticks) input.checked = this.now[key];
    const horizon = this.ticks.find((one) => one.key === 'showsHorizon')!.input;
    horizon.disabled = tab === 'camera';  // which shows it
    horizon.checked ||= horizon.disabled;
    text(
        this.render,
        busy === 'render' && progress?.total ? `Rendering ${Math.round((100 * progress.done) / progress.total)} %` :
                                               'Render …');
  }
}
customElements.define('studio-tools', ToolBar);
