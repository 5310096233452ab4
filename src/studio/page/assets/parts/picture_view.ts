// SPDX-License-Identifier: Apache-2.0
import type {BoxPx} from '../model/contract';
import {STATED, TO_MOMENTS, flyerAt} from '../model/flyers';
import {type Point, clamp} from '../model/geometry';
import type {Look, Member} from '../model/store';
import {OverlayLayer} from './overlay_layer';
import {Part, attribute, h, s, text, ui} from './part';
import {PathLayer} from './path_layer';

const MOST_SCALE = 40;
const PAN_SHARE = 0.1;
const WHEEL_RATE = 0.0015;
const PIXELS_FROM_SCALE = 3;  // frame pixels are shown as squares from here on

// The frame on a canvas, and above it drawings in the frame's own coordinates. The wheel zooms about the pointer, the
// background is dragged, two fingers do both.
export class PictureView extends Part {
  protected readonly watches: Member[] = [
    'clip', 'look', 'plan', 'state', 'frame', 'selected', 'moment', 'draft', 'picture', 'showsBoxes', 'showsHorizon',
    'showsMotion', 'connected', 'tab'
  ];
  private canvas = h('canvas', {role: 'img', 'aria-label': 'The frame with the aircraft in it'});
  private svg = s('svg', {class: 'over', role: 'group', 'aria-label': 'Paths over the frame'});
  // Where the pointer is in the frame.
  private pixel = h('output', {class: 'pixel', hidden: true, 'aria-hidden': 'true'});
  private overlay = new OverlayLayer();
  private paths = new PathLayer(this.studio, (event) => this.pixelAt(event));
  private pointers = new Map<number, Point>();
  private dragged = false;

  protected build(): void {
    this.svg.append(this.paths.element, this.overlay.element);
    this.append(this.canvas, this.svg, this.pixel);
    this.studio.pictures.onDrawn = (header) => {
      this.draw(header.crop);
      this.studio.store.put({picture: header});
    };
    new ResizeObserver(() => this.resized()).observe(this);
    this.addEventListener('wheel', (event) => this.wheel(event), {passive: false});
    this.addEventListener('pointerdown', (event) => this.down(event));
    this.addEventListener('pointermove', (event) => {
      this.read(event);
      this.move(event);
    });
    this.addEventListener('pointerleave', () => this.read(null));
    for (const end of ['pointerup', 'pointercancel'] as const) this.addEventListener(end, (event) => this.up(event));
    this.addEventListener('dblclick', (event) => this.doubleClick(event));
  }

  protected update(changed: Set<Member>): void {
    if (changed.has('look') || changed.has('clip')) this.draw();
    attribute(this.svg, 'viewBox', this.shown.join(' '));
    const px = ui() / this.scale;
    const room = this.shown;
    this.overlay.update(this.now, px, room, this.paths.update(px, room));
  }

  // All of the frame, in the middle.
  fit(): void {
    this.studio.store.put({look: null});
  }

  zoom(factor: number, about?: Point): void {
    const {clip} = this.now;
    if (!clip) return;
    const {look} = this;
    const scale = clamp(look.scale * factor, this.fitted.scale * 0.5, MOST_SCALE);
    const box = this.getBoundingClientRect();
    const [px, py] = about ?? [box.width / 2, box.height / 2];
    this.studio.store.put(
        {look: {scale, x: look.x + px / look.scale - px / scale, y: look.y + py / look.scale - py / scale}});
  }

  // By a part of what is shown.
  pan(right: number, down: number): void {
    if (!this.now.clip) return;
    const {x, y, scale} = this.look;
    const step = (PAN_SHARE * Math.min(this.clientWidth, this.clientHeight)) / scale;
    this.studio.store.put({look: {scale, x: x + right * step, y: y + down * step}});
  }

  private get fitted(): Look {
    const {clip} = this.now;
    if (!clip || !this.clientWidth || !this.clientHeight) return {x: 0, y: 0, scale: 1};
    const scale = Math.min(this.clientWidth / clip.width, this.clientHeight / clip.height);
    return {scale, x: (clip.width - this.clientWidth / scale) / 2, y: (clip.height - this.clientHeight / scale) / 2};
  }

  private get look(): Look {
    return this.now.look ?? this.fitted;
  }

  private get scale(): number {
    return this.look.scale;
  }

  private pixelAt(event: {clientX: number; clientY: number}): Point {
    const box = this.getBoundingClientRect();
    return [
      this.look.x + (event.clientX - box.left) / this.scale, this.look.y + (event.clientY - box.top) / this.scale
    ];
  }

  private resized(): void {
    const ratio = window.devicePixelRatio;
    [this.canvas.width, this.canvas.height] =
        [Math.max(1, Math.round(this.clientWidth * ratio)), Math.max(1, Math.round(this.clientHeight * ratio))];
    this.draw();
    this.update(new Set());
  }

  // What of the frame's coordinates is in the panel.
  private get shown(): BoxPx {
    const {x, y, scale} = this.look;
    return [x, y, Math.max(1, this.clientWidth) / scale, Math.max(1, this.clientHeight) / scale];
  }

  private read(event: PointerEvent|null): void {
    this.pixel.hidden = !event || !this.now.clip;
    if (event) text(this.pixel, `${this.pixelAt(event).map((v) => v.toFixed(1)).join(', ')} px`);
  }

  // The frame, or what changed of it.
  private draw(part?: BoxPx): void {
    const context = this.canvas.getContext('2d')!;
    const {x, y, scale} = this.look;
    const on = scale * window.devicePixelRatio;
    context.setTransform(1, 0, 0, 1, 0, 0);
    if (!part) context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    const {clip} = this.now;
    if (!clip) return;
    context.setTransform(on, 0, 0, on, -x * on, -y * on);
    context.imageSmoothingEnabled = on < PIXELS_FROM_SCALE;
    context.imageSmoothingQuality = 'medium';
    const [left, top, width, height] = part ?? [0, 0, clip.width, clip.height];
    context.drawImage(this.studio.pictures.canvas, left, top, width, height, left, top, width, height);
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const factor = Math.exp(-event.deltaY * (event.deltaMode === 1 ? 20 : 1) * WHEEL_RATE * (event.ctrlKey ? 4 : 1));
    if (this.paths.wheel(event, factor)) return;
    const box = this.getBoundingClientRect();
    this.zoom(factor, [event.clientX - box.left, event.clientY - box.top]);
  }

  private down(event: PointerEvent): void {
    if (event.button !== 0) return;
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    this.dragged = false;
    if (this.paths.down(event)) return;
    // A click must not end on the element that holds the pointer.
    (event.target as Element).setPointerCapture(event.pointerId);
  }

  private move(event: PointerEvent): void {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const after: Point = [event.clientX, event.clientY];
    const others = [...this.pointers].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
    this.pointers.set(event.pointerId, after);
    if (others.length) {
      this.pinch(before, after, others[0]);
      return;
    }
    if (this.paths.move(event)) return;
    const [dx, dy] = [after[0] - before[0], after[1] - before[1]];
    if (!dx && !dy) return;
    if (!this.dragged) this.sayIfOnAircraft(this.pixelAt({clientX: before[0], clientY: before[1]}));
    this.dragged = true;
    const {x, y, scale} = this.look;
    this.studio.store.put({look: {scale, x: x - dx / scale, y: y - dy / scale}});
  }

  // A drag beside the handles moves the picture, also one that begins on an aircraft.
  private sayIfOnAircraft([x, y]: Point): void {
    const {picture, state} = this.now;
    const on =
        picture?.boxes.find(({box: [left, top, w, h]}) => x >= left && y >= top && x <= left + w && y <= top + h);
    const flyer = on && flyerAt(state, on.table);
    if (!flyer) return;
    const has = flyer.statement === 'moments';
    this.studio.store.say(
        'info',
        `${flyer.id} is moved by the handles of its path. ${
            has ? 'M adds one in the frame shown.' :
                  `Its path is stated ${STATED[flyer.statement]}. “${TO_MOMENTS}” gives it some.`}`);
  }

  private pinch(before: Point, after: Point, other: Point): void {
    const apart = (a: Point) => Math.max(1, Math.hypot(a[0] - other[0], a[1] - other[1]));
    const factor = apart(after) / apart(before);
    if (this.paths.pinch(factor)) return;
    const box = this.getBoundingClientRect();
    this.zoom(factor, [(after[0] + other[0]) / 2 - box.left, (after[1] + other[1]) / 2 - box.top]);
  }

  private up(event: PointerEvent): void {
    if (!this.pointers.delete(event.pointerId)) return;
    const wasPath = this.paths.up(event);
    if (!wasPath && !this.dragged && !this.paths.isOf(event.target) && event.type === 'pointerup')
      this.studio.store.put({moment: null});
  }

  private doubleClick(event: MouseEvent): void {
    const {clip, state, selected} = this.now;
    if (!clip || !state || this.paths.isHandle(event.target)) return;
    const pixel = this.pixelAt(event);
    const onPath = this.paths.pathOf(event.target);
    if (onPath) this.studio.select(onPath);
    if (onPath || selected)
      this.studio.addMoment(onPath ? null : pixel);
    else
      this.studio.store.put({dialog: 'gallery', addsAt: pixel});
  }
}
customElements.define('studio-picture', PictureView);
