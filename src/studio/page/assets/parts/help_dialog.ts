// SPDX-License-Identifier: Apache-2.0
import type {Member} from '../model/store';
import {DialogPart} from './dialog';
import {h} from './part';

const GESTURES: [string, string][] = [
  ['drag a handle', 'the aircraft is at that pixel at that time'],
  ['wheel or pinch on a handle', 'nearer or farther'],
  ['double-click the path', 'a moment there, in the frame shown'],
  ['double-click the picture', 'a moment at that pixel; a new aircraft if none is chosen'],
  ['wheel, drag the background', 'zoom and move the picture'],
  ['drag in the views below', 'closest approach, course, range and time of moments'],
];
const KEYS: [string, string][] = [
  ['← →', 'one frame; with Shift ten'],
  ['Home, End', 'first and last frame'],
  ['Space', 'play or pause'],
  ['[ ]', 'moment before and after'],
  ['M', 'a moment of the chosen path in this frame'],
  ['Delete', 'remove the chosen moment; on the heading of a flyer, the flyer'],
  ['arrows on a handle', 'move it by 1 px; with Shift 10 px'],
  ['+ − on a handle', 'nearer or farther'],
  ['N', 'add aircraft, birds, drones'],
  ['1 2 3 4', 'flyers, light, camera, text'],
  ['+ − F, W A S D', 'zoom, the whole frame, move the picture'],
  ['Ctrl+Z, Ctrl+Shift+Z', 'undo, redo'],
  ['Ctrl+S', 'save'],
  ['R', 'render'],
  ['Escape', 'let go; in a field, its last value and back to the picture'],
];

// Gestures and keys.
export class HelpDialog extends DialogPart {
  protected readonly watches: Member[] = ['dialog'];
  protected readonly name = 'help';
  protected readonly title_ = 'Gestures and keys';

  protected fill(): Node[] {
    const table = (rows: [string, string][]) =>
        h('table', {}, ...rows.map(([what, does]) => h('tr', {}, h('th', {scope: 'row'}, what), h('td', {}, does))));
    return [h('div', {class: 'help'}, table(GESTURES), table(KEYS))];
  }
}
customElements.define('studio-help', HelpDialog);
