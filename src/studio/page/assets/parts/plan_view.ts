// SPDX-License-Identifier: Apache-2.0
import type {BoxPx, Change, Clip, Ned, Plan, Track} from '../model/contract';
import {type Flyer, acrossOf, flyerAt, isSame, momentsOf, numberOf, setAcross, statedCourse, tableOf, trackOf, withCourse, writtenRange, writtenWidth} from '../model/flyers';
import {type Point, courseOf, degrees, frameAt, freePlace, nedAt, radians, round, turned, velocityAt} from '../model/geometry';
import {arrow, renewed, s, wordsWidth} from './part';
import {type Drag, SideView, niceStep} from './side_view';

const MARGIN_PX = 26;
const MOST_M = 20000;  // from the own path, of what the view has room for
const LEAST_M = 60;
const ARROW_PX = 46;
const LABEL_PX = 12;

// From north-east metres to the view's: right and up, the own course at the beginning upwards.
interface Ground {
  right: number;
  ahead: number;
}

// From above, the own course upwards: paths, the field of view, well-clear volumes, closest approaches. Closest
// approaches, courses and the ranges of moments are dragged.
export class PlanView extends SideView {
  private course_deg = 0;
  private origin: Ned = [0, 0, 0];
  private middle: Ground = {right: 0, ahead: 0};
  private scale = 1;  // screen pixels a metre
  private labels: {words: string; at: Point; away: number}[] = [];
  private taken: BoxPx[] = [];  // by handles, marks and labels

  constructor() {
    super('From above', 'Plan view, own course up', 'its range');
  }

  protected draw(plan: Plan, clip: Clip, flyers: Flyer[], own: Ned|null, width: number, height: number): void {
    if (!this.drag) this.frameAll(plan, clip, width, height);
    this.labels = [];
    this.taken = [];
    renewed(this.svg, [
      this.grid(width, height),
      ...(own ? [this.fieldOfView(plan, own), ...this.volumes(plan, own)] : []),
      s('polyline', {class: 'own', points: this.points(plan, plan.own.ned)}),
      ...flyers.flatMap((flyer) => this.flyer(flyer, plan, clip, own)),
      ...(own ? [this.ownMark(plan, clip, own)] : []),
    ]);
    this.svg.append(this.placedLabels(width, height));
  }

  // Above all else, in the view and beside handles.
  private placedLabels(width: number, height: number): SVGGElement {
    const h = 1.25 * LABEL_PX * this.px;
    return s('g', {class: 'labels'}, ...this.labels.map(({words, at: [x, y], away}) => {
      const w = wordsWidth(words, LABEL_PX * this.px);
      const far = away + 2 * h;
      const box = freePlace(
          [w, h],
          [
            [x + away, y - h / 2], [x - away - w, y - h / 2], [x - w / 2, y - away - h], [x - w / 2, y + away],
            [x - w / 2, y - far - h], [x - w / 2, y + far], [x + far, y - h / 2], [x - far - w, y - h / 2]
          ],
          [0, 0, width, height], this.taken);
      this.taken.push(box);
      return s('text', {x: box[0], y: box[1] + LABEL_PX * this.px}, words);
    }));
  }

  protected override take(x: number, y: number, r: number): void {
    this.taken.push([x - r, y - r, 2 * r, 2 * r]);
  }

  private ground([n, e]: Ned): Ground {
    const [dn, de] = [n - this.origin[0], e - this.origin[1]];
    const [c, si] = [Math.cos(radians(this.course_deg)), Math.sin(radians(this.course_deg))];
    return {right: de * c - dn * si, ahead: dn * c + de * si};
  }

  protected at(ned: Ned): Point {
    return this.screen(this.ground(ned));
  }

  private screen({right, ahead}: Ground): Point {
    return [
      this.svg.clientWidth / 2 + (right - this.middle.right) * this.scale,
      this.svg.clientHeight / 2 - (ahead - this.middle.ahead) * this.scale
    ];
  }

  private groundAt(event: PointerEvent): Ground {
    const box = this.svg.getBoundingClientRect();
    return {
      right: (event.clientX - box.left - box.width / 2) / this.scale + this.middle.right,
      ahead: -(event.clientY - box.top - box.height / 2) / this.scale + this.middle.ahead
    };
  }

  // The view holds the own path and, of the others, what is not too far away.
  private frameAll(plan: Plan, clip: Clip, width: number, height: number): void {
    this.origin = plan.own.ned[0] ?? [0, 0, 0];
    this.course_deg = courseOr(velocityAt(plan, plan.own.ned, 0, clip), plan.own.heading_deg);
    const others = plan.tracks.flatMap((track) => [...track.ned, approachOf(plan, track, clip)?.place ?? null]);
    const near = others.filter(
        (ned): ned is Ned => ned !== null && Math.hypot(ned[0] - this.origin[0], ned[1] - this.origin[1]) < MOST_M);
    const all = [...plan.own.ned, ...near].map((ned) => this.ground(ned));
    const [rights, aheads] = [all.map((one) => one.right), all.map((one) => one.ahead)];
    const [left, right, low, high] =
        [Math.min(...rights), Math.max(...rights), Math.min(...aheads), Math.max(...aheads)];
    this.middle = {right: (left + right) / 2, ahead: (low + high) / 2};
    const room = [Math.max(40, width - 2 * MARGIN_PX * this.px), Math.max(40, height - 2 * MARGIN_PX * this.px)];
    this.scale = Math.min(room[0] / Math.max(LEAST_M, right - left), room[1] / Math.max(LEAST_M, high - low));
  }

  // Lines at whole steps of metres, and how long a step is.
  private grid(width: number, height: number): SVGGElement {
    const step_m = niceStep((90 * this.px) / this.scale);
    const group = s('g', {class: 'grid'});
    const [x0, y0] = this.screen({right: 0, ahead: 0});
    const step = step_m * this.scale;
    for (let x = x0 % step; x < width; x += step) group.append(s('line', {x1: x, x2: x, y1: 0, y2: height}));
    for (let y = y0 % step; y < height; y += step) group.append(s('line', {x1: 0, x2: width, y1: y, y2: y}));
    const words = step_m >= 1000 ? `${step_m / 1000} km` : `${step_m} m`;
    this.taken.push(
        [0, height - 32 * this.px, Math.max(step, wordsWidth(words, LABEL_PX * this.px)) + 12, 32 * this.px]);
    group.append(
        s('path', {class: 'scale', d: `M8,${height - 12 * this.px}v${6 * this.px}h${round(step, 1)}v${- 6 * this.px}`}),
        s('text', {x: 12, y: height - 16 * this.px}, words));
    return group;
  }

  private fieldOfView(plan: Plan, own: Ned): SVGPathElement {
    const half = radians(plan.horizontal_fov_deg / 2);
    const [x, y] = this.at(own);
    const far = Math.hypot(this.svg.clientWidth, this.svg.clientHeight);
    const edge = (sign: number) => {
      const angle = radians(plan.own.heading_deg - this.course_deg) + sign * half;
      return `${round(x + far * Math.sin(angle), 1)},${round(y - far * Math.cos(angle), 1)}`;
    };
    return s('path', {class: 'view', d: `M${round(x, 1)},${round(y, 1)}L${edge(-1)}L${edge(1)}Z`});
  }

  private volumes(plan: Plan, own: Ned): SVGElement[] {
    const [cx, cy] = this.at(own);
    return plan.volumes.filter((volume) => volume.horizontal_m > 0).map((volume) => {
      const r = volume.horizontal_m * this.scale;
      this.labels.push({words: volume.name, at: [cx, cy - r - LABEL_PX * this.px], away: 0});
      return s(
          'g', {class: 'volume'},
          s('circle', {cx, cy, r}, s('title', {}, `${volume.name}: ${round(volume.horizontal_m, 0)} m`)));
    });
  }

  private ownMark(plan: Plan, clip: Clip, own: Ned): SVGGElement {
    const velocity = velocityAt(plan, plan.own.ned, this.now.frame, clip);
    const angle = courseOr(velocity, this.course_deg) - this.course_deg;
    const [x, y] = this.at(own);
    this.take(x, y, 9 * this.px);
    return s(
        'g', {
          class: 'own-mark',
          transform: `translate(${round(x, 1)} ${round(y, 1)}) rotate(${round(angle, 1)}) scale(${this.px})`
        },
        s('path', {d: 'M0,-9L6,7L0,3L-6,7Z'}, s('title', {}, 'The own aircraft')));
  }

  protected override place([x, y]: Point, flyer: Flyer, own: Ned|null): SVGElement[] {
    if (!own) return [];
    this.take(x, y, 5 * this.px);
    const [mark] = super.place([x, y], flyer, own);
    mark.append(s('title', {}, flyer.id));
    if (!isSame(flyer.path, this.now.selected)) return [mark];
    const [ox, oy] = this.at(own);
    return [s('line', {class: 'sight', x1: ox, y1: oy, x2: x, y2: y}), mark];
  }

  protected approach(flyer: Flyer, track: Track, plan: Plan, clip: Clip): SVGElement[] {
    const cpa = approachOf(plan, track, clip);
    if (!cpa) return [];
    const [[x, y], [ox, oy]] = [this.at(cpa.place), this.at(cpa.own)];
    const words = `${round(track.cpa!.distance_m, 0)} m at ${round(track.cpa!.time_s, 1)} s`;
    this.take(x, y, 7 * this.px);
    this.labels.push({words, at: [x, y], away: 10 * this.px});
    const parts: SVGElement[] = [
      s('line', {class: 'miss', x1: ox, y1: oy, x2: x, y2: y}),
      this.diamond(
          flyer, x, y, `Closest approach of ${flyer.id}: ${words}`, (event) => this.key(event, flyer, 'approach')),
    ];
    if (flyer.statement !== 'approach') return parts;
    parts.unshift(this.acrossLine(flyer, cpa, plan, clip));
    const course = statedCourse(flyer);
    const angle = radians(course + cpa.ownCourse_deg - this.course_deg);
    const [tx, ty] = [x + ARROW_PX * this.px * Math.sin(angle), y - ARROW_PX * this.px * Math.cos(angle)];
    this.take(tx, ty, 7 * this.px);
    parts.push(
        s('line', {class: 'course', x1: x, y1: y, x2: tx, y2: ty}),
        s('circle', {
          class: 'turn grab',
          cx: tx,
          cy: ty,
          r: 6 * this.px,
          tabindex: 0,
          role: 'button',
          'data-drag': 'course',
          'aria-label': `Course of ${flyer.id}: ${round(course, 0)} degrees from the own course. Arrow keys turn it.`,
          onkeydown: ((event: KeyboardEvent) => this.key(event, flyer, 'course')) as EventListener
        },
          s('title', {}, `Course ${round(course, 0)}° from the own course`)));
    return parts;
  }

  // Where the diamond can be: across the relative velocity, since elsewhere the two would not be nearest.
  private acrossLine(flyer: Flyer, {own, ownCourse_deg}: CpaPlace, plan: Plan, clip: Clip): SVGElement {
    const {across} = acrossOf(flyer, plan, clip);
    const turn = radians(ownCourse_deg - this.course_deg);
    const far = this.svg.clientWidth + this.svg.clientHeight;
    const right = far * (across[0] * Math.cos(turn) + across[1] * Math.sin(turn));
    const ahead = far * (across[1] * Math.cos(turn) - across[0] * Math.sin(turn));
    const [x, y] = this.at(own);
    return s('line', {class: 'across', x1: x - right, y1: y + ahead, x2: x + right, y2: y - ahead});
  }

  protected down(event: PointerEvent): void {
    if (event.button !== 0) return;
    const {flyer, kind, index} = this.pressed(event);
    if (!flyer || !kind) return;
    // What is drawn may be older than the scene.
    if (kind !== 'moment' || this.studio.choose(index)) this.hold(event, kind, flyer, index);
  }

  protected changesOf({kind, flyer: begin, index}: Drag, event: PointerEvent): Change[] {
    const {plan, clip, state} = this.now;
    const flyer = begin && (flyerAt(state, begin.path) ?? begin);
    const track = flyer && trackOf(plan, flyer.path);
    if (!plan || !clip || !begin || !track) return [];
    const to = this.groundAt(event);
    if (kind === 'moment') return this.rangeChange(flyer, index, track, plan, clip, to);
    const cpa = approachOf(plan, track, clip);
    if (!cpa) return [];
    const from = this.ground(kind === 'course' ? cpa.place : cpa.own);
    const [right, ahead] = [to.right - from.right, to.ahead - from.ahead];
    if (kind === 'course')
      return withCourse(
          flyer, plan, clip, round(turned(degrees(Math.atan2(right, ahead)) + this.course_deg - cpa.ownCourse_deg), 0),
          begin);
    const turn = radians(cpa.ownCourse_deg - this.course_deg);
    const where = acrossOf(flyer, plan, clip);
    const {across} = where;
    const own = [right * Math.cos(turn) - ahead * Math.sin(turn), ahead * Math.cos(turn) + right * Math.sin(turn)];
    return setAcross(flyer, where, own[0] * across[0] + own[1] * across[1]);
  }

  // Along the line of sight: farther is smaller.
  private rangeChange(flyer: Flyer, index: number, track: Track, plan: Plan, clip: Clip, to: Ground): Change[] {
    const moment = momentsOf(flyer, clip)[index];
    const handle = track.handles[index];
    const [own, place] =
        [moment && nedAt(plan, plan.own.ned, moment.frame), moment && nedAt(plan, track.ned, moment.frame)];
    if (!moment || !handle?.range_m || !own || !place) return [];
    const [from, there] = [this.ground(own), this.ground(place)];
    const sight: Point = [there.right - from.right, there.ahead - from.ahead];
    const length = Math.hypot(...sight);
    if (length < 1e-3) return [];
    const along = ((to.right - from.right) * sight[0] + (to.ahead - from.ahead) * sight[1]) / length;
    const range_m = Math.max(5, (handle.range_m * along) / length);
    if (moment.width_px !== null && handle.width_px !== null)
      return [{set: [...moment.path, 'width_px'], to: writtenWidth((handle.width_px * handle.range_m) / range_m)}];
    return [{set: [...moment.path, 'range_m'], to: writtenRange(range_m)}];
  }

  private key(event: KeyboardEvent, flyer: Flyer, kind: 'approach'|'course'): void {
    const {plan, clip} = this.now;
    const by = plan && clip && arrow(event);
    if (!by) return;
    const step = (by[0] + by[1]) * (event.shiftKey ? 10 : 1);
    const encounter = tableOf(flyer.table.encounter);
    if (kind === 'course') {
      this.studio.edit(withCourse(flyer, plan, clip, turned(statedCourse(flyer) + step)), 'course-keys');
      return;
    }
    const key = 'cpa_ahead_m' in encounter && !('cpa_right_m' in encounter) ? 'cpa_ahead_m' : 'cpa_right_m';
    this.studio.edit(
        [{set: [...flyer.path, 'encounter', key], to: round((numberOf(encounter[key]) ?? 0) + step, 1)}],
        'approach-keys');
  }
}
customElements.define('studio-plan', PlanView);

// Of what hovers another one.
const courseOr = (velocity: Ned|null, otherwise_deg: number) =>
    velocity && Math.hypot(velocity[0], velocity[1]) > 0.1 ? courseOf(velocity) : otherwise_deg;

interface CpaPlace {
  own: Ned;
  place: Ned;
  ownCourse_deg: number;
}

// Where the two are at their closest approach.
function approachOf(plan: Plan, track: Track, clip: Clip): CpaPlace|null {
  if (!track.cpa) return null;
  const frame = frameAt(track.cpa.time_s, clip);
  const own = nedAt(plan, plan.own.ned, frame);
  const velocity = velocityAt(plan, plan.own.ned, frame, clip);
  if (!own || !velocity) return null;
  const ownCourse_deg = courseOr(velocity, 0);
  const [c, si] = [Math.cos(radians(ownCourse_deg)), Math.sin(radians(ownCourse_deg))];
  const {right_m, ahead_m, above_m} = track.cpa;
  return {
    own,
    place: [own[0] + ahead_m * c - right_m * si, own[1] + ahead_m * si + right_m * c, own[2] - above_m],
    ownCourse_deg
  };
}
