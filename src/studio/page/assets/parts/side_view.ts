// SPDX-License-Identifier: Apache-2.0
import type {Change, Clip, Ned, Plan, Track} from '../model/contract';
import {type Flyer, flyerAt, flyersOf, isSame, momentsOf, trackOf} from '../model/flyers';
import {type Point, nedAt, round, timeAt} from '../model/geometry';
import type {Member} from '../model/store';
import {Part, attribute, h, s, ui} from './part';

export interface Drag {
  kind: 'approach'|'course'|'moment'|'time';
  flyer: Flyer|null;  // as it was when the drag began
  index: number;
  merge: string;
}

// A view of the plan beside the picture, whose handles are dragged.
export abstract class SideView extends Part {
  protected readonly watches: Member[] = ['plan', 'frame', 'selected', 'moment', 'clip'];
  protected readonly svg = s('svg', {role: 'group'});
  protected drag: Drag|null = null;
  protected px = 1;  // ui()

  // `forMoments`: what a moment is dragged for, "its time".
  constructor(private heading: string, label: string, private forMoments: string) {
    super();
    this.svg.setAttribute('aria-label', label);
  }

  protected abstract down(event: PointerEvent): void;
  protected abstract changesOf(drag: Drag, event: PointerEvent): Change[];

  protected build(): void {
    this.append(h('h2', {}, this.heading), this.svg);
    new ResizeObserver(() => this.update()).observe(this.svg);
    this.svg.addEventListener('pointerdown', (event) => this.down(event));
    this.svg.addEventListener('pointermove', (event) => this.move(event));
    for (const end of ['pointerup', 'pointercancel'] as const) this.svg.addEventListener(end, () => this.up());
  }

  protected update(): void {
    const {plan, state, clip, frame} = this.now;
    const [width, height] = [this.svg.clientWidth, this.svg.clientHeight];
    if (!plan || !state || !clip || !plan.frames.length || !width || !height) return;
    this.px = ui();
    attribute(this.svg, 'viewBox', `0 0 ${width} ${height}`);
    this.draw(plan, clip, flyersOf(state.scene), nedAt(plan, plan.own.ned, frame), width, height);
  }

  // `own`: where the own aircraft is in the frame shown.
  protected abstract draw(plan: Plan, clip: Clip, flyers: Flyer[], own: Ned|null, width: number, height: number): void;
  // Where a place is in the view at a time.
  protected abstract at(ned: Ned, time_s: number): Point;
  // The closest approach of the selected flyer.
  protected abstract approach(flyer: Flyer, track: Track, plan: Plan, clip: Clip): SVGElement[];
  // No label stands on what is taken.
  protected take(_x: number, _y: number, _r: number): void {}

  protected points(plan: Plan, ned: (Ned|null)[]): string {
    const clip = this.now.clip!;
    const at = (place: Ned, frame: number) => this.at(place, timeAt(frame, clip)).map((v) => round(v, 1)).join();
    return plan.frames.flatMap((frame, k) => (ned[k] ? [at(ned[k]!, frame)] : [])).join(' ');
  }

  // The path of a flyer with its place in the frame shown, and the handles of the selected one.
  protected flyer(flyer: Flyer, plan: Plan, clip: Clip, own: Ned|null): SVGElement[] {
    const track = trackOf(plan, flyer.path);
    if (!track) return [];
    const group = this.group(flyer, this.points(plan, track.ned));
    const now = nedAt(plan, track.ned, this.now.frame);
    if (now) group.append(...this.place(this.at(now, timeAt(this.now.frame, clip)), flyer, own));
    if (isSame(flyer.path, this.now.selected))
      group.append(...this.approach(flyer, track, plan, clip), ...this.moments(flyer, track, plan, clip));
    return [group];
  }

  protected place([cx, cy]: Point, _flyer: Flyer, _own: Ned|null): SVGElement[] {
    return [s('circle', {class: 'place', cx, cy, r: 4.5 * this.px})];
  }

  private moments(flyer: Flyer, track: Track, plan: Plan, clip: Clip): SVGElement[] {
    return momentsOf(flyer, clip).flatMap(({frame, time_s}, index) => {
      const place = nedAt(plan, track.ned, frame);
      if (!place) return [];
      const [x, y] = this.at(place, time_s);
      this.take(x, y, 6 * this.px);
      return [this.square(index, time_s, x, y)];
    });
  }

  // The flyer under the pointer, which becomes the selected one, and the handle of it.
  protected pressed(event: PointerEvent):
      {group: Element|null; flyer: Flyer | null; kind?: Drag['kind']; index: number} {
    const target = event.target as SVGElement;
    const group = target.closest<SVGElement>('.flyer');
    const flyer = group && flyerAt(this.now.state, JSON.parse(group.dataset.path!));
    if (flyer && !isSame(flyer.path, this.now.selected)) this.studio.select(flyer.path);
    return {
      group,
      flyer,
      kind: target.dataset.drag as Drag['kind'] | undefined,
      index: Number(target.dataset.index ?? 0)
    };
  }

  protected hold(event: PointerEvent, kind: Drag['kind'], flyer: Flyer|null, index: number): void {
    this.drag = {kind, flyer, index, merge: this.studio.merge(kind)};
    this.svg.setPointerCapture(event.pointerId);
    if (kind !== 'time') this.studio.dragging(true);
  }

  private move(event: PointerEvent): void {
    const {drag} = this;
    const changes = drag ? this.changesOf(drag, event) : [];
    if (drag && changes.length) this.studio.edit(changes, drag.merge, event.timeStamp);
  }

  private up(): void {
    if (this.drag && this.drag.kind !== 'time') this.studio.dragging(false);
    this.drag = null;
  }

  // The line of a flyer through points.
  private group(flyer: Flyer, points: string): SVGGElement {
    return s(
        'g', {
          class: `flyer colour-${flyer.colour}${isSame(flyer.path, this.now.selected) ? ' selected' : ''}`,
          'data-path': JSON.stringify(flyer.path)
        },
        s('polyline', {class: 'line', points}), s('polyline', {class: 'grip', points}));
  }

  // The closest approach; a handle where the path is stated by it.
  protected diamond(flyer: Flyer, x: number, y: number, label: string, key: (event: KeyboardEvent) => void):
      SVGPathElement {
    const isHandle = flyer.statement === 'approach';
    const r = 7 * this.px;
    return s(
        'path', {
          class: `diamond${isHandle ? ' grab' : ''}`,
          d: `M${x},${y - r}L${x + r},${y}L${x},${y + r}L${x - r},${y}Z`,
          tabindex: isHandle ? 0 : null,
          role: 'button',
          'aria-label': `${label}. Arrow keys move it.`,
          'data-drag': isHandle ? 'approach' : null,
          onkeydown: key as EventListener
        },
        s('title', {}, label));
  }

  // The handle of a moment.
  private square(index: number, time_s: number, x: number, y: number): SVGRectElement {
    return s(
        'rect', {
          class: `moment grab${this.now.moment === index ? ' chosen' : ''}`,
          x: x - 5 * this.px,
          y: y - 5 * this.px,
          width: 10 * this.px,
          height: 10 * this.px,
          'data-drag': 'moment',
          'data-index': index
        },
        s('title', {}, `${round(time_s, 2)} s: drag for ${this.forMoments}`));
  }
}

// 1, 2 or 5 times a power of ten, at least as much as given.
export function niceStep(least: number): number {
  const power = 10 ** Math.floor(Math.log10(least));
  return ([1, 2, 5, 10].find((k) => k * power >= least) ?? 10) * power;
}
