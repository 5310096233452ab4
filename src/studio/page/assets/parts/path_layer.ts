// SPDX-License-Identifier: Apache-2.0
import type {BoxPx, Clip, LinePoint, Path} from '../model/contract';
import {type Flyer, type Moment, flyersOf, isSame, momentsOf, nearer, trackOf, writtenPixel} from '../model/flyers';
import {type Point, clamp, degrees, freePlace, mix, round, timeAt} from '../model/geometry';
import type {Studio} from '../model/studio';
import {distance} from './overlay_layer';
import {Keyed, arrow, attribute, s, text, wordsWidth} from './part';

const HANDLE_PX = 8;
const RIM_PX = 11;  // from the panel's edge, of a handle that is drawn there
const LABEL_PX = 12;
const AWAY_PX = 14;    // of a label from its handle's middle
const PAUSE_MS = 500;  // after which turning the wheel on is a new step of undo
const FAR = 30000;     // pixels beyond which a path is not drawn

interface Line {
  points: LinePoint[];
  flyer: Flyer;
  isSelected: boolean;
}

// A handle as it is drawn: at its place, or at the rim of the panel, pointing to it.
interface Handle {
  moment: Moment;
  flyer: Flyer;
  index: number;
  at: Point;
  points_deg: number|null;
  words: string;
  label: BoxPx;
}

interface Held {
  moment: Moment;
  flyer: Flyer;
  offset: Point;
  merge: string;
  last: Point;
  isMoved: boolean;
}

// The paths of all that flies, in the frame's coordinates, and the moments of the selected one as handles.
export class PathLayer {
  readonly element = s('g', {class: 'paths'});
  private tracks: Keyed<Line, SVGGElement>;
  private handles: Keyed<Handle, SVGGElement>;
  private held: Held|null = null;
  private isWheel = false;
  private wheelMerge = {name: '', at: -Infinity};
  private px = 1;  // frame pixels of a screen pixel

  constructor(private studio: Studio, private pixelAt: (event: PointerEvent) => Point) {
    const [lines, handles] = [s('g'), s('g')];
    this.element.append(lines, handles);
    this.tracks = new Keyed(lines, (_, key) => this.makeTrack(key), (element, item) => this.renewTrack(element, item));
    this.handles = new Keyed(handles, () => this.makeHandle(), (element, item) => this.renewHandle(element, item));
  }

  // Returns what handles and their labels cover.
  update(px: number, room: BoxPx): BoxPx[] {
    this.px = px;
    const {state, clip, selected} = this.studio.store.now;
    if (!state || !clip) return [];
    const flyers = flyersOf(state.scene);
    this.tracks.show(flyers.flatMap((flyer) => {
      const points = this.pointsOf(flyer.path);
      return points.length ?
          [{key: JSON.stringify(flyer.path), item: {points, flyer, isSelected: isSame(selected, flyer.path)}}] :
          [];
    }));
    const flyer = flyers.find((one) => isSame(one.path, selected));
    const moments = flyer?.statement === 'moments' ? momentsOf(flyer, clip) : [];
    const handles = flyer ? this.placed(moments, flyer, room, clip) : [];
    this.handles.show(handles.map((item) => ({key: `${JSON.stringify(selected)}${item.index}`, item})));
    return [...handles.map((one) => this.ringOf(one.at)), ...handles.map((one) => one.label)];
  }

  private ringOf([x, y]: Point): BoxPx {
    const r = (HANDLE_PX + 2) * this.px;
    return [x - r, y - r, 2 * r, 2 * r];
  }

  private placed(moments: Moment[], flyer: Flyer, room: BoxPx, clip: Clip): Handle[] {
    const {px} = this;
    const places = moments.map((moment) => this.placeOf(moment, flyer));
    const rings = places.map((place) => atRim(place, room, RIM_PX * px));
    const taken = rings.map((ring) => this.ringOf(ring));
    return moments.map((moment, index) => {
      const [at, place] = [rings[index], places[index]];
      const [x, y] = this.draftOf(moment) ?? moment.pixel;
      const isOutside = x < 0 || y < 0 || x > clip.width || y > clip.height;
      const words = `${round(moment.time_s, 2)} s${isOutside ? ', outside the picture' : ''}`;
      const [w, h] = [wordsWidth(words, LABEL_PX) * px, 1.25 * LABEL_PX * px];
      const away = AWAY_PX * px;
      const label = freePlace(
          [w, h],
          [
            [at[0] - w / 2, at[1] + away], [at[0] - w / 2, at[1] - away - h], [at[0] + away, at[1] - h / 2],
            [at[0] - away - w, at[1] - h / 2]
          ],
          room, taken);
      taken.push(label);
      const points_deg = at === place ? null : degrees(Math.atan2(place[1] - at[1], place[0] - at[0]));
      return {moment, flyer, index, at, points_deg, words, label};
    });
  }

  private draftOf(moment: Moment): Point|null {
    const {draft} = this.studio.store.now;
    return draft && isSame(draft.path, moment.path) ? draft.pixel : null;
  }

  // As the camera of the frame shown would see it.
  private placeOf(moment: Moment, flyer: Flyer): Point {
    const isThere = moment.frame === this.studio.store.now.frame;
    return this.draftOf(moment) ?? (isThere ? null : placeOn(this.pointsOf(flyer.path), moment.frame)) ?? moment.pixel;
  }

  isOf(target: EventTarget|null): boolean {
    return target instanceof Element && target.closest('.track, .handle') !== null;
  }

  isHandle(target: EventTarget|null): boolean {
    return target instanceof Element && target.closest('.handle') !== null;
  }

  pathOf(target: EventTarget|null): Path|null {
    const track = target instanceof Element ? target.closest<SVGElement>('.track') : null;
    return track ? JSON.parse(track.dataset.path!) : null;
  }

  // A press on a handle holds it and shows its time; one on a path selects it.
  down(event: PointerEvent): boolean {
    const handle = (event.target as Element).closest<SVGGElement>('.handle');
    if (handle) {
      const {flyer} = this.studio;
      const index = Number(handle.dataset.index);
      const moment = this.studio.moment(index);
      if (!flyer || !moment) return false;
      const at = this.pixelAt(event);
      // In another frame the camera looks elsewhere, and at the rim it is not: then the handle comes to the pointer.
      const isThere = moment.frame === this.studio.store.now.frame && !handle.classList.contains('rim');
      handle.setPointerCapture(event.pointerId);
      handle.focus();
      this.held = {
        moment,
        flyer,
        merge: this.studio.merge('drag'),
        offset: isThere ? [moment.pixel[0] - at[0], moment.pixel[1] - at[1]] : [0, 0],
        last: moment.pixel,
        isMoved: false
      };
      this.studio.store.put({playing: false});
      this.studio.choose(index);
      this.studio.dragging(true);
      return true;
    }
    const path = this.pathOf(event.target);
    if (path) this.studio.select(path);
    return false;
  }

  move(event: PointerEvent): boolean {
    const {held} = this;
    if (!held) return false;
    const at = this.pixelAt(event);
    this.moveTo(held, [at[0] + held.offset[0], at[1] + held.offset[1]], event.timeStamp);
    return true;
  }

  up(event: PointerEvent): boolean {
    const {held} = this;
    if (!held) return false;
    if (event.type === 'pointerup' && held.isMoved) this.move(event);
    this.held = null;
    this.studio.dragging(false);
    return true;
  }

  // Whether the wheel turned above a handle, which then becomes nearer or farther.
  wheel(event: WheelEvent, factor: number): boolean {
    const handle = (event.target as Element).closest<SVGGElement>('.handle');
    const {moment} = this.studio.store.now;
    // The handle may have left the pointer, as another frame came with the first turn.
    const isGoingOn = moment !== null && this.isWheel && event.timeStamp - this.wheelMerge.at < PAUSE_MS;
    this.isWheel = isGoingOn || handle !== null;
    if (!this.isWheel) return false;
    const index = isGoingOn ? moment : Number(handle!.dataset.index);
    if (this.studio.store.now.moment !== index) this.studio.store.put({moment: index});
    this.size(index, factor, event.timeStamp);
    return true;
  }

  pinch(factor: number): boolean {
    if (!this.held) return false;
    const {moment} = this.studio.store.now;
    if (moment !== null) this.size(moment, factor, performance.now());
    return true;
  }

  private size(index: number, factor: number, moved_ms: number): void {
    const moment = this.studio.moment(index);
    const change = moment && nearer(moment, factor);
    if (!moment || !change) return;
    if (moved_ms - this.wheelMerge.at > PAUSE_MS) this.wheelMerge.name = this.studio.merge('size');
    this.wheelMerge.at = moved_ms;
    this.studio.show(moment.frame);
    this.studio.edit([change], this.wheelMerge.name, moved_ms);
  }

  private moveTo(held: Held, pixel: Point, moved_ms: number): void {
    const to = writtenPixel(pixel);
    if (to[0] === held.last[0] && to[1] === held.last[1]) return;
    held.last = to;
    held.isMoved = true;
    this.studio.store.put({draft: {path: held.moment.path, pixel: to}});
    this.studio.edit([{set: [...held.moment.path, 'pixel'], to}], held.merge, moved_ms);
  }

  private key(event: KeyboardEvent, index: number): void {
    const {flyer} = this.studio;
    const moment = this.studio.moment(index);
    if (!flyer || !moment || event.ctrlKey || event.altKey || event.metaKey) return;
    const step = event.shiftKey ? 10 : 1;
    const by = arrow(event);
    if (by) {
      if (event.timeStamp - this.wheelMerge.at > PAUSE_MS) this.wheelMerge.name = this.studio.merge('keys');
      this.wheelMerge.at = event.timeStamp;
      const from = this.draftOf(moment) ?? moment.pixel;
      this.studio.show(moment.frame);
      this.moveTo(
          {moment, flyer, offset: [0, 0], merge: this.wheelMerge.name, last: from, isMoved: false},
          [from[0] + step * by[0], from[1] - step * by[1]], event.timeStamp);
      return;
    }
    if (event.key === '+' || event.key === '=')
      this.size(index, 1.05, event.timeStamp);
    else if (event.key === '-')
      this.size(index, 1 / 1.05, event.timeStamp);
    else
      return;
    event.preventDefault();
    event.stopPropagation();
  }

  private makeTrack(key: string): SVGGElement {
    return s(
        'g', {'data-path': key}, s('path', {class: 'under'}), s('path', {class: 'beyond'}), s('path', {class: 'line'}),
        s('path', {class: 'grip'}), s('path', {class: 'seconds'}));
  }

  private renewTrack(element: SVGGElement, {points, flyer, isSelected}: Line): void {
    attribute(element, 'class', `track colour-${flyer.colour}${isSelected ? ' selected' : ''}`);
    const {clip} = this.studio.store.now;
    if (!clip) return;
    const isIn = ([x, y]: Point) => x >= 0 && y >= 0 && x <= clip.width && y <= clip.height;
    const all = pathData(points, () => true);
    const seen = pathData(points, isIn);
    for (const [k, data] of [all, all, seen, all].entries()) attribute(element.children[k], 'd', data);
    attribute(element.children[4], 'd', secondsOf(points, isIn, clip, 2.2 * this.px));
  }

  // As the camera of the picture that is shown would see it.
  private pointsOf(path: Path): LinePoint[] {
    return this.studio.store.now.picture?.lines.find((one) => isSame(one.table, path))?.points ?? [];
  }

  private makeHandle(): SVGGElement {
    const handle: SVGGElement =
        s('g', {
          tabindex: 0,
          role: 'button',
          onkeydown: ((event: KeyboardEvent) => this.key(event, Number(handle.dataset.index))) as EventListener,
          onfocus: () => this.focused(Number(handle.dataset.index))
        },
          s('circle', {class: 'reach'}), s('circle', {class: 'ring'}), s('circle', {class: 'dot'}),
          s('path', {class: 'arrow', d: 'M8,0L-5,5L-2,0L-5,-5Z'}), s('text'));
    return handle;
  }

  private focused(index: number): void {
    if (!this.held && this.studio.store.now.moment !== index) this.studio.choose(index);
  }

  private renewHandle(element: SVGGElement, {moment, flyer, index, at, points_deg, words, label}: Handle): void {
    const {frame, moment: chosen, plan} = this.studio.store.now;
    const [x, y] = at;
    attribute(
        element, 'class',
        `handle colour-${flyer.colour}${chosen === index ? ' chosen' : ''}${moment.frame === frame ? ' current' : ''}${
            points_deg === null ? '' : ' rim'}`);
    attribute(element, 'data-index', index);
    const {px} = this;
    for (const [k, radius] of [16, HANDLE_PX, 2.5].entries()) {
      attribute(element.children[k], 'cx', x);
      attribute(element.children[k], 'cy', y);
      attribute(element.children[k], 'r', radius * px);
    }
    attribute(element.children[3], 'transform', `translate(${x} ${y}) rotate(${points_deg ?? 0}) scale(${px})`);
    const line = element.children[4];
    attribute(line, 'x', label[0]);
    attribute(line, 'y', label[1] + LABEL_PX * px);
    attribute(line, 'font-size', LABEL_PX * px);
    text(line, words);
    const known = trackOf(plan, flyer.path)?.handles[index];
    const size = [
      known?.range_m && distance(known.range_m), known?.width_px && `${round(known.width_px, 1)} px wide`
    ].filter(Boolean).join(', ');
    attribute(
        element, 'aria-label',
        `Moment ${index + 1} of ${flyer.id}: ${words}, at ${round(moment.pixel[0], 1)}, ${
            round(
                moment.pixel[1],
                1)} px${size ? `, ${size}` : ''}. Arrow keys move it, plus and minus change its size.`);
  }
}

// The same place, or the nearest in a panel where it is beyond its edges.
function atRim(place: Point, [left, top, width, height]: BoxPx, rim: number): Point {
  const [x, y] = place;
  if (x >= left && y >= top && x <= left + width && y <= top + height) return place;
  return [clamp(x, left + rim, left + width - rim), clamp(y, top + rim, top + height - rim)];
}

// A line that is broken where it has no place, is too far away, or is not as asked.
function pathData(points: LinePoint[], isDrawn: (point: Point) => boolean): string {
  let data = '';
  let isDown = false;
  for (const [, x, y] of points) {
    const isIn = x !== null && y !== null && Math.abs(x) < FAR && Math.abs(y) < FAR && isDrawn([x, y]);
    if (isIn) data += `${isDown ? 'L' : 'M'}${x},${y}`;
    isDown = isIn;
  }
  return data;
}

// Where a line is at a frame.
function placeOn(points: LinePoint[], frame: number): Point|null {
  const k = points.findIndex((point) => point[0] >= frame);
  if (k < 0) return null;
  const [a, b] = [points[Math.max(0, k - 1)], points[k]];
  if (a[1] === null || a[2] === null || b[1] === null || b[2] === null || a[0] > frame) return null;
  const share = b[0] > a[0] ? (frame - a[0]) / (b[0] - a[0]) : 0;
  return [mix(a[1], b[1], share), mix(a[2], b[2], share)];
}

// A dot at every whole second in view.
function secondsOf(points: LinePoint[], isDrawn: (point: Point) => boolean, clip: Clip, radius: number): string {
  let data = '';
  let last = -1;
  for (const [frame, x, y] of points) {
    const second = Math.floor(timeAt(frame, clip) + 1e-6);
    if (x !== null && y !== null && second !== last && isDrawn([x, y]))
      data += `M${round(x - radius, 2)},${y}a${radius},${radius} 0 1 0 ${2 * radius},0a${radius},${radius} 0 1 0 ${
          - 2 * radius},0`;
    last = second;
  }
  return data;
}
