// SPDX-License-Identifier: Apache-2.0
import type {Change, Clip, Ned, Plan, Track} from '../model/contract';
import {type Flyer, frameOf, momentsOf, numberOf, roomOf, tableOf, timeOf} from '../model/flyers';
import {type Point, clamp, frameAt, nedAt, round, timeAt} from '../model/geometry';
import {arrow, renewed, s} from './part';
import {type Drag, SideView, niceStep} from './side_view';

// Around the plot, where text is 16 px: left, right, top and bottom.
const MARGINS = [56, 12, 10, 24];
const LEAST_M = 40;
const MOST_ABOVE_M = 1500;  // from the own height, of what the view has room for

// Heights over time: own path, the others, the ground, volumes about the own height. Closest approaches are dragged in
// time and height, moments in time.
export class HeightView extends SideView {
  private low_m = 0;
  private high_m = 100;
  // The margins on the screen.
  private left = MARGINS[0];
  private right = MARGINS[1];
  private top = MARGINS[2];
  private bottom = MARGINS[3];

  constructor() {
    super('Height over time', 'Height over time', 'its time');
  }

  protected draw(plan: Plan, clip: Clip, flyers: Flyer[], own: Ned|null, width: number, height: number): void {
    [this.left, this.right, this.top, this.bottom] = MARGINS.map((margin) => margin * this.px);
    if (!this.drag) this.frameAll(plan);
    const x = this.x(timeAt(this.now.frame, clip));
    renewed(this.svg, [
      this.axes(width, height),
      ...(own ? plan.volumes.filter((one) => one.vertical_m > 0)
                    .map((one) => this.volume(plan, one.vertical_m, one.name)) :
                []),
      s('polyline', {class: 'own', points: this.points(plan, plan.own.ned)}),
      s('line', {class: 'cursor', x1: x, x2: x, y1: this.top, y2: height - this.bottom}),
      ...flyers.flatMap((flyer) => this.flyer(flyer, plan, clip, own)),
    ]);
  }

  private get end_s(): number {
    const {clip} = this.now;
    return clip ? Math.max(0.1, timeAt(clip.frames - 1, clip)) : 1;
  }

  private x(time_s: number): number {
    return this.left + (time_s / this.end_s) * (this.svg.clientWidth - this.left - this.right);
  }

  private y(height_m: number): number {
    return this.top +
        ((this.high_m - height_m) / (this.high_m - this.low_m)) * (this.svg.clientHeight - this.top - this.bottom);
  }

  protected at(ned: Ned, time_s: number): Point {
    return [this.x(time_s), this.y(-ned[2])];
  }

  private timeAt(event: PointerEvent): number {
    const box = this.svg.getBoundingClientRect();
    return ((event.clientX - box.left - this.left) / (box.width - this.left - this.right)) * this.end_s;
  }

  private heightAt(event: PointerEvent): number {
    const box = this.svg.getBoundingClientRect();
    return this.high_m -
        ((event.clientY - box.top - this.top) / (box.height - this.top - this.bottom)) * (this.high_m - this.low_m);
  }

  private frameAll(plan: Plan): void {
    const own = plan.own.ned.map((ned) => -ned[2]);
    const middle = own[0] ?? 0;
    const others = plan.tracks.flatMap(
        (track) => track.ned.flatMap((ned) => (ned && Math.abs(-ned[2] - middle) < MOST_ABOVE_M ? [-ned[2]] : [])));
    const [low, high] = [Math.min(...own, ...others), Math.max(...own, ...others)];
    const room = Math.max(LEAST_M, high - low) * 0.15;
    [this.low_m, this.high_m] = [Math.min(low, high - LEAST_M) - room, Math.max(high, low + LEAST_M) + room];
  }

  private axes(width: number, height: number): SVGGElement {
    const group = s('g', {class: 'grid'});
    const metres =
        niceStep((this.high_m - this.low_m) / Math.max(2, (height - this.top - this.bottom) / (36 * this.px)));
    for (let m = Math.ceil(this.low_m / metres) * metres; m <= this.high_m; m += metres)
      group.append(
          s('line', {x1: this.left, x2: width - this.right, y1: this.y(m), y2: this.y(m)}),
          s('text', {class: 'end', x: this.left - 5 * this.px, y: this.y(m) + 4 * this.px}, `${round(m, 1)} m`));
    const seconds = niceStep(this.end_s / Math.max(2, (width - this.left - this.right) / (90 * this.px)));
    for (let t = 0; t <= this.end_s + 1e-6; t += seconds) {
      group.append(
          s('line', {x1: this.x(t), x2: this.x(t), y1: this.top, y2: height - this.bottom}),
          s('text', {
            class: this.x(t) > width - 30 * this.px ? 'end' : 'middle',
            x: Math.min(this.x(t), width - 3),
            y: height - 8 * this.px
          },
            `${round(t, 2)} s`));
    }
    if (this.low_m < 0)
      group.append(
          s('rect', {
            class: 'earth',
            x: this.left,
            width: Math.max(0, width - this.left - this.right),
            y: this.y(0),
            height: Math.max(0, height - this.bottom - this.y(0))
          },
            s('title', {}, 'Below the ground')));
    return group;
  }

  private volume(plan: Plan, vertical_m: number, name: string): SVGGElement {
    const edge = (above_m: number) => this.points(plan, plan.own.ned.map(([n, e, d]): Ned => [n, e, d - above_m]));
    return s(
        'g', {class: 'volume'},
        ...[1, -1].map(
            (sign) => s(
                'polyline', {points: edge(sign * vertical_m)}, s('title', {}, `${name}: ${round(vertical_m, 0)} m`))));
  }

  protected approach(flyer: Flyer, track: Track, plan: Plan, clip: Clip): SVGElement[] {
    if (!track.cpa || track.cpa.time_s < 0 || track.cpa.time_s > this.end_s) return [];
    const own = nedAt(plan, plan.own.ned, frameAt(track.cpa.time_s, clip));
    if (!own) return [];
    const [x, y, oy] = [this.x(track.cpa.time_s), this.y(-own[2] + track.cpa.above_m), this.y(-own[2])];
    const label =
        `Closest approach of ${flyer.id}: ${round(track.cpa.time_s, 1)} s, ${round(track.cpa.above_m, 0)} m above`;
    return [
      s('line', {class: 'miss', x1: x, x2: x, y1: oy, y2: y}),
      this.diamond(flyer, x, y, label, (event) => this.key(event, flyer)),
    ];
  }

  protected down(event: PointerEvent): void {
    if (event.button !== 0 || !this.now.state) return;
    const {group, flyer, kind = 'time', index} = this.pressed(event);
    if (kind === 'moment') this.studio.store.put({moment: index});
    this.hold(event, kind, flyer, index);
    if (kind === 'time' && !group) this.studio.show(frameAt(this.timeAt(event), this.now.clip!));
  }

  protected changesOf({kind, flyer, index}: Drag, event: PointerEvent): Change[] {
    const {plan, clip} = this.now;
    if (kind === 'time' && clip) this.studio.show(frameAt(this.timeAt(event), clip));
    if (kind === 'time' || !plan || !clip || !flyer) return [];
    const time_s = clamp(this.timeAt(event), 0, this.end_s);
    if (kind === 'moment') {
      const moments = momentsOf(flyer, clip);
      if (!moments[index]) return [];
      const [first, last] = roomOf(moments, index, clip);
      if (last < first) return [];
      const frame = clamp(frameOf(time_s, clip), first, last);
      this.studio.show(frame);
      return [{set: [...moments[index].path, 'time_s'], to: timeOf(frame, clip)}];
    }
    const own = nedAt(plan, plan.own.ned, frameAt(time_s, clip));
    const key = (name: string) => [...flyer.path, 'encounter', name];
    const above: Change[] = own ? [{set: key('cpa_above_m'), to: round(this.heightAt(event) + own[2], 1)}] : [];
    return [{set: key('cpa_time_s'), to: round(time_s, 2)}, ...above];
  }

  private key(event: KeyboardEvent, flyer: Flyer): void {
    const by = arrow(event);
    if (!by) return;
    const [key, step] = by[0] ? ['cpa_time_s', 0.1 * by[0]] : ['cpa_above_m', by[1]];
    const value = numberOf(tableOf(flyer.table.encounter)[key]) ?? 0;
    this.studio.edit(
        [{set: [...flyer.path, 'encounter', key], to: round(value + step * (event.shiftKey ? 10 : 1), 2)}],
        'approach-keys');
  }
}
customElements.define('studio-height', HeightView);
