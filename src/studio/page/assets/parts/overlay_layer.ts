// SPDX-License-Identifier: Apache-2.0
import type {BoxPx, Clip, ExactBox} from '../model/contract';
import {flyersOf, isSame, trackOf} from '../model/flyers';
import {freePlace, nedAt, round, speedOf, velocityAt} from '../model/geometry';
import type {Everything} from '../model/store';
import {Keyed, attribute, s, text, wordsWidth} from './part';

const LABEL_PX = 13;

interface Box {
  exact: ExactBox;
  colour: number;
  isSelected: boolean;
  label: string;
  at: BoxPx;  // of the label
}

// What is measured or follows, drawn over the frame: boxes with range and size, the horizon, and directions of the
// world.
export class OverlayLayer {
  readonly element = s('g', {class: 'overlay'});
  private horizon = s('line', {class: 'horizon'});
  private motion = s('g', {class: 'motion'});
  private px = 1;  // frame pixels of a screen pixel
  private boxes: Keyed<Box, SVGGElement>;

  constructor() {
    const boxes = s('g');
    this.element.append(this.motion, this.horizon, boxes);
    this.boxes = new Keyed<Box, SVGGElement>(
        boxes, () => s('g', {}, s('path'), s('text')), (element, box) => this.renew(element, box));
  }

  // Labels are in the room and beside what is taken.
  update(now: Readonly<Everything>, px: number, room: BoxPx, taken: BoxPx[]): void {
    this.px = px;
    this.showHorizon(now);
    this.showMotion(now);
    const {picture, state, showsBoxes} = now;
    const flyers = state ? flyersOf(state.scene) : [];
    const shown = showsBoxes ? picture?.boxes ?? [] : [];
    const tables = shown.map((one) => JSON.stringify(one.table));
    taken.push(...shown.map((one) => one.box));
    this.boxes.show(shown.map((exact, k) => {
      const flyer = flyers.find((one) => isSame(one.path, exact.table));
      const isSelected = isSame(now.selected, exact.table);
      // Of a flock one bird has the label.
      const isFirst = tables.indexOf(tables[k]) === k;
      const count = tables.filter((one) => one === tables[k]).length;
      const [w, h] = [exact.box[2], exact.box[3]];
      const mark = trackOf(now.plan, exact.table)?.checks.length ? '⚠ ' : '';
      const words = mark + (count > 1 ? `${flyer?.id ?? exact.id}  ${count} in view` : exact.id);
      const label = !isFirst ?
          '' :
          isSelected ?
          `${words}  ${distance(exact.range_m)}${count > 1 ? '' : `  ${round(w, 1)} × ${round(h, 1)} px`}` :
          words;
      const at = this.labelAt(exact.box, label, room, taken);
      if (label) taken.push(at);
      return {key: exact.id, item: {exact, colour: flyer?.colour ?? 0, isSelected, label, at}};
    }));
  }

  private labelAt([x, y, width, height]: BoxPx, words: string, room: BoxPx, taken: BoxPx[]): BoxPx {
    const {px} = this;
    const [w, h, gap] = [wordsWidth(words, LABEL_PX) * px, 1.25 * LABEL_PX * px, 4 * px];
    const [left, right, above, below] = [x - gap - w, x + width + gap, y - gap - h, y + height + gap];
    const middle = x + (width - w) / 2;
    return freePlace(
        [w, h],
        [
          [right, above], [left, above], [right, below], [left, below], [middle, above - h], [middle, below + h],
          [middle, above - 3 * h], [middle, below + 3 * h]
        ],
        room, taken);
  }

  private renew(element: SVGGElement, {exact, colour, isSelected, label: words, at}: Box): void {
    attribute(element, 'class', `box colour-${colour}${isSelected ? ' selected' : ''}`);
    const [path, label] = [element.children[0], element.children[1]];
    const {px} = this;
    const [x, y, w, h] = exact.box;
    const [x0, y0, x1, y1] = [x - 3 * px, y - 3 * px, x + w + 3 * px, y + h + 3 * px];
    const arm = Math.min(12 * px, (x1 - x0) / 3, (y1 - y0) / 3);
    const corner = (cx: number, cy: number, dx: number, dy: number) => `M${cx + dx * arm},${cy}H${cx}V${cy + dy * arm}`;
    attribute(path, 'd', corner(x0, y0, 1, 1) + corner(x1, y0, -1, 1) + corner(x0, y1, 1, -1) + corner(x1, y1, -1, -1));
    attribute(label, 'x', at[0]);
    attribute(label, 'y', at[1] + LABEL_PX * px);
    attribute(label, 'font-size', LABEL_PX * px);
    text(label, words);
  }

  private showHorizon({plan, frame, showsHorizon, tab}: Readonly<Everything>): void {
    const line = (showsHorizon || tab === 'camera') && plan ? nearest(plan.horizon, frame) : null;
    this.horizon.toggleAttribute('hidden', !line);
    if (line)
      for (const [k, name] of ['x1', 'y1', 'x2', 'y2'].entries()) attribute(this.horizon, name, line[k]);
  }

  // Directions of the world, which stay on clouds and far ground where the measured motion is right: azimuths on the
  // row nearest the middle of the picture, elevations below the nearest column's. And the own speed in words.
  private showMotion({plan, clip, frame, showsMotion, picture}: Readonly<Everything>): void {
    this.motion.replaceChildren();
    if (!showsMotion || !plan || !clip) return;
    const {px} = this;
    const marks = picture?.directions ?? [];
    const middle = marks.reduce<typeof marks[0]|null>(
        (best, one) => (!best || offMiddle(one, clip) < offMiddle(best, clip) ? one : best), null);
    const arm = 6 * px;
    for (const [azimuth, elevation, x, y] of marks) {
      this.motion.append(s('path', {d: `M${x - arm},${y}h${2 * arm}M${x},${y - arm}v${2 * arm}`}));
      if (elevation === middle![1]) this.motion.append(this.words(x + 4 * px, y - 4 * px, `${azimuth}°`));
      if (azimuth === middle![0])
        this.motion.append(
            this.words(x + 4 * px, y + LABEL_PX * px, `${Math.abs(elevation)}° ${elevation < 0 ? 'down' : 'up'}`));
    }
    // To the next frame.
    const velocity = velocityAt(plan, plan.own.ned, frame + 0.5, clip);
    const own = nedAt(plan, plan.own.ned, frame);
    if (velocity && own)
      this.motion.append(this.words(
          10 * px, clip.height - 10 * px,
          `own speed ${round(speedOf(velocity), 1)} m/s, height ${round(-own[2], 0)} m`));
  }

  private words(x: number, y: number, words: string): SVGTextElement {
    return s('text', {x, y, 'font-size': LABEL_PX * this.px}, words);
  }
}

const offMiddle = ([, , x, y]: [number, number, number, number], clip: Clip) =>
    Math.hypot(x - clip.width / 2, y - clip.height / 2);

export const distance = (range_m: number) => (
    range_m < 9950 ? `${range_m < 100 ? round(range_m, 1) : Math.round(range_m)} m` : `${round(range_m / 1000, 1)} km`);

function nearest<Value>(all: [number, Value][], frame: number): Value|null {
  const best = all.reduce<[number, Value]|null>(
      (found, one) => (!found || Math.abs(one[0] - frame) < Math.abs(found[0] - frame) ? one : found), null);
  return best ? best[1] : null;
}
