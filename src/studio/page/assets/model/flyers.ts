// SPDX-License-Identifier: Apache-2.0
import type {Approach, Change, Clip, Json, Ned, Path, Plan, State, Table, Track} from './contract';
import {type Point, clamp, courseOf, frameAt, isPlaced, mix, nedAt, radians, relativeOf, round, speedOf, timeAt, turned, velocityAt} from './geometry';

// Of a scene's numbers (src/scene/scene/limits.h).
export const MOST_MISS_M = 1e5;
export const SPEEDS_MPS: [number, number] = [1e-3, 1e4];

// How a flyer's path is stated.
export type Statement = 'moments'|'approach'|'waypoints'|'file'|'drift'|'lens';
export const STATED: Record<Statement, string> = {
  moments: 'by moments in the picture',
  approach: 'by its closest approach',
  waypoints: 'by waypoints',
  file: 'by a path file',
  drift: 'by a place and a velocity',
  lens: 'on the lens',
};
export const TO_MOMENTS = 'State by moments in the picture';
export type Kind = 'aircraft'|'bird'|'multirotor'|'balloon'|'glint'|'dirt'|'insect';

// An intruder or a distractor of the scene.
export interface Flyer {
  path: Path;
  table: Table;
  id: string;
  kind: Kind;
  title: string;
  statement: Statement;
  colour: number;  // of the seven of the palette
}

export interface Moment {
  path: Path;
  frame: number;
  time_s: number;
  pixel: Point;
  range_m: number|null;
  width_px: number|null;
}

const PALETTE = 7;
const tables = (value: Json|undefined): Table[] => (Array.isArray(value) ? (value as Table[]) : []);
export const tableOf = (value: Json|undefined): Table =>
    (value && typeof value === 'object' && !Array.isArray(value) ? value : {});
export const numberOf = (value: Json|undefined): number|null => (typeof value === 'number' ? value : null);
export const isSame = (a: Path|null, b: Path|null) => JSON.stringify(a) === JSON.stringify(b);

function statementOf(table: Table, kind: Kind): Statement {
  if (kind === 'glint' || kind === 'dirt' || kind === 'insect') return 'lens';
  if ('seen' in table) return 'moments';
  if ('encounter' in table) return 'approach';
  if ('path_file' in table) return 'file';
  return 'position_ned_m' in table ? 'drift' : 'waypoints';
}

export function flyersOf(scene: Table): Flyer[] {
  const intruders =
      tables(scene.intruder).map((table, k) => ({table, path: ['intruder', k] as Path, kind: 'aircraft' as Kind, k}));
  const counts = new Map<string, number>();
  const others = tables(scene.distractor).map((table, k) => {
    const kind = String(table.kind) as Kind;
    counts.set(kind, (counts.get(kind) ?? 0) + 1);
    return {table, path: ['distractor', k] as Path, kind, k: counts.get(kind)! - 1};
  });
  return [...intruders, ...others].map(({table, path, kind, k}, place) => ({
                                         path,
                                         table,
                                         kind,
                                         id: String(table.id ?? `${kind === 'aircraft' ? 'intruder' : kind}-${k + 1}`),
                                         title: titleOf(table, kind),
                                         statement: statementOf(table, kind),
                                         colour: place % PALETTE,
                                       }));
}

function titleOf(table: Table, kind: Kind): string {
  if (kind === 'aircraft') return String(table.aircraft ?? 'no aircraft');
  const count = numberOf(table.count) ?? 1;
  return count > 1 ? `${count} ${kind}s` : kind;
}

export function flyerAt(state: State|null, path: Path|null): Flyer|null {
  return state && path ? flyersOf(state.scene).find((one) => isSame(one.path, path)) ?? null : null;
}

export function trackOf(plan: Plan|null, path: Path|null): Track|null {
  return plan?.tracks.find((one) => isSame(one.table, path)) ?? null;
}

export const frameOf = (time_s: number, clip: Clip) => Math.round(frameAt(time_s, clip));
export const timeOf = (frame: number, clip: Clip) => round(timeAt(frame, clip), 3);

export function momentsOf(flyer: Flyer, clip: Clip): Moment[] {
  return tables(flyer.table.seen).map((seen, k) => {
    const time_s = numberOf(seen.time_s) ?? 0;
    const pixel = Array.isArray(seen.pixel) ? (seen.pixel as Point) : ([0, 0] as Point);
    const path = [...flyer.path, 'seen', k];
    return {
      path,
      time_s,
      frame: frameOf(time_s, clip),
      pixel,
      range_m: numberOf(seen.range_m),
      width_px: numberOf(seen.width_px)
    };
  });
}

// The first and the last frame where a moment can be: between the two beside it.
export function roomOf(moments: Moment[], index: number, clip: Clip): [number, number] {
  return [(moments[index - 1]?.frame ?? -1) + 1, (moments[index + 1]?.frame ?? clip.frames) - 1];
}

// As it is written: tenths of a pixel, and four digits of a distance.
export const writtenPixel = ([x, y]: Point): Point => [round(x, 1), round(y, 1)];
export const writtenRange = (range_m: number) => Number(clamp(range_m, 0.1, 1e6).toPrecision(4));
export const writtenWidth = (width_px: number) => round(clamp(width_px, 0.1, 1e5), 1);

// A moment made nearer by a factor, in the words that it is stated in.
export function nearer(moment: Moment, factor: number): Change|null {
  if (moment.width_px !== null) return {set: [...moment.path, 'width_px'], to: writtenWidth(moment.width_px * factor)};
  if (moment.range_m !== null) return {set: [...moment.path, 'range_m'], to: writtenRange(moment.range_m / factor)};
  return null;
}

const seenTable = (time_s: number, pixel: Point, range_m: number): Table =>
    ({time_s, pixel: writtenPixel(pixel), range_m: writtenRange(range_m)});

// A moment at a frame: a new one in its place in time, or the one that is there moved.
export function withMoment(
    flyer: Flyer, clip: Clip, frame: number, pixel: Point, range_m: number): {changes: Change[]; index: number} {
  const moments = momentsOf(flyer, clip);
  const there = moments.findIndex((one) => one.frame === frame);
  if (there >= 0) return {changes: [{set: [...moments[there].path, 'pixel'], to: writtenPixel(pixel)}], index: there};
  const after = moments.findIndex((one) => one.frame > frame);
  const index = after < 0 ? moments.length : after;
  return {
    changes: [{insert: [...flyer.path, 'seen'], at: index, table: seenTable(timeOf(frame, clip), pixel, range_m)}],
    index
  };
}

const PATH_KEYS = [
  'encounter', 'seen', 'waypoints_ned_m', 'speed_mps', 'times_s', 'path_file', 'start_s', 'position_ned_m',
  'velocity_ned_mps', 'offset_ned_m'
];
const removed = (flyer: Flyer): Change[] =>
    PATH_KEYS.filter((key) => key in flyer.table).map((key) => ({remove: [...flyer.path, key]}));

// The same path by moments in the picture: where it is in view, three of them.
export function toMoments(flyer: Flyer, track: Track, clip: Clip): Change[]|null {
  const inClip =
      track.points.filter(isPlaced).filter((point) => point[0] >= 0 && point[0] < clip.frames && point[3] > 0);
  const seen = inClip.filter((point) => point[5]);
  const chosen = seen.length >= 2 ? seen : inClip;
  if (chosen.length < 2) return null;
  const places = chosen.length >= 3 ? [0, Math.floor((chosen.length - 1) / 2), chosen.length - 1] : [0, 1];
  const moments = places.map((k) => chosen[k]);
  const inserts = moments.map((point, at): Change => ({
                                insert: [...flyer.path, 'seen'],
                                at,
                                table: seenTable(timeOf(point[0], clip), [point[1], point[2]], point[3])
                              }));
  return [...removed(flyer), ...inserts];
}

// The closest approach of two that go straight on from a frame at the clip's end, seconds later (or before, if < 0).
function beyondClip(plan: Plan, track: Track, frame: number, own: Ned, other: Ned) {
  const [here, there] = [nedAt(plan, plan.own.ned, frame), nedAt(plan, track.ned, frame)];
  if (!here || !there) return null;
  const [n, e, d] = [0, 1, 2].map((k) => other[k] - own[k]);
  const apart = [0, 1, 2].map((k) => there[k] - here[k]);
  const later_s = -(apart[0] * n + apart[1] * e + apart[2] * d) / Math.max(1e-9, n * n + e * e + d * d);
  const [north, east, down] = [apart[0] + n * later_s, apart[1] + e * later_s, apart[2] + d * later_s];
  const course = radians(courseOf(own));
  return {later_s, right_m: east * Math.cos(course) - north * Math.sin(course), above_m: -down};
}

// The same path by its closest approach: its place and its velocity there.
export function toApproach(flyer: Flyer, track: Track, plan: Plan, clip: Clip): Change[]|null {
  const cpa = track.cpa;
  if (!cpa) return null;
  const frame = clamp(frameAt(cpa.time_s, clip), plan.frames[0], plan.frames[plan.frames.length - 1]);
  const [own, other] = [velocityAt(plan, plan.own.ned, frame, clip), velocityAt(plan, track.ned, frame, clip)];
  if (!own || !other) return null;
  const course = round(turned(courseOf(other) - courseOf(own)), 1);
  const climb = round(-other[2], 1);
  const near = frame <= plan.frames[0] || frame >= plan.frames[plan.frames.length - 1] ?
      beyondClip(plan, track, frame, own, other) :
      {later_s: 0, right_m: cpa.right_m, above_m: cpa.above_m};
  if (!near) return null;
  const words: [string, number][] = [
    ['cpa_time_s', round(cpa.time_s + near.later_s, 2)],
    ['cpa_right_m', round(near.right_m, 1)],
    ['cpa_above_m', round(near.above_m, 1)],
    ['course_deg', course],
    ['speed_mps', Math.max(0.1, round(speedOf(other), 1))],
    ...(climb ? ([['climb_mps', climb]] as [string, number][]) : []),
  ];
  return byEncounter(flyer, Object.fromEntries(words));
}

// By an encounter that the server found: its numbers by their keys.
export const byEncounter = (flyer: Flyer, encounter: Table): Change[] =>
    [...removed(flyer),
     ...Object.entries(encounter).map(([key, to]): Change => ({set: [...flyer.path, 'encounter', key], to}))];

// What the gallery offers.
export interface Choice {
  kind: Kind;
  aircraft?: string;
  length_m: number;
  count?: number;
}

// Of the picture's width, for what is new; a flock takes some more than a bird of it.
const NEW_SHARE = 0.05;
const SMALL_SHARE = 0.025;
const FLOCK_SHARE = 0.014;
const NEAREST_SHARE = 0.5;  // of its first range, for the second moment
const CRUISE_MPS: Partial<Record<Kind, number>> = {
  bird: 12,
  multirotor: 8,
  balloon: 2
};
const cruise = (choice: Choice) => CRUISE_MPS[choice.kind] ?? (choice.length_m > 20 ? 110 : 50);

// Pixels of an object of 1 m at 1 m; a guess where a file states the lens.
export function focalOf(scene: Table, clip: Clip): number {
  const lens = tableOf(scene.lens);
  if (Array.isArray(lens.focal_px)) return Number(lens.focal_px[0]);
  const fov = numberOf(lens.vertical_fov_deg);
  return fov && fov < 179 ? clip.height / 2 / Math.tan(radians(fov) / 2) : clip.width * 0.8;
}

// Where the horizon is in a frame, on the column of a pixel; none where the camera does not see it.
function horizonAt(plan: Plan, frame: number, x: number): number|null {
  const after = plan.horizon.findIndex((one) => one[0] >= frame);
  if (after < 0) return null;
  const [a, b] = [plan.horizon[Math.max(0, after - 1)], plan.horizon[after]];
  if (a[1][0] === a[1][2] || b[1][0] === b[1][2]) return null;
  const [from, to] = [a, b].map(([, [x1, y1, x2, y2]]) => mix(y1, y2, (x - x1) / (x2 - x1)));
  return mix(from, to, b[0] > a[0] ? clamp((frame - a[0]) / (b[0] - a[0]), 0, 1) : 0);
}

// A flyer that crosses the picture, and the way of the own aircraft, and is at a pixel in the frame shown. It flies
// level where the horizon is known.
export function newFlyer(choice: Choice, scene: Table, clip: Clip, frame: number, at: Point, plan: Plan|null): Table {
  const own_mps = plan ? ownSpeed(plan, frame, clip) : 0;
  const focal_px = focalOf(scene, clip);
  const isFlock = choice.count !== undefined && choice.count > 1;
  const width_px = Math.max(
      14,
      clip.width *
          (choice.kind === 'aircraft' ? NEW_SHARE :
               isFlock                ? FLOCK_SHARE :
                                        SMALL_SHARE));
  const range_m = (choice.length_m * focal_px) / width_px;
  const rate_px_s = (cruise(choice) * width_px) / choice.length_m;
  const span = clip.frames - 1;
  const lasts_s = Math.min((clip.width * 0.45) / rate_px_s, (range_m * (1 - NEAREST_SHARE)) / Math.max(1, own_mps));
  const way = Math.max(1, Math.min(span, Math.round(clamp(lasts_s, 0.5, 6) * clip.rate_hz)));
  // One of the two moments is the frame shown: the camera moves, so a place between two others is a guess.
  const isEarly = span - frame >= Math.min(way, clip.rate_hz, frame);
  const [first, last] = isEarly ? [frame, Math.min(frame + way, span)] : [Math.max(0, frame - way), frame];
  const direction = at[0] < clip.width / 2 ? 1 : -1;
  const rangeAt = (k: number) =>
      Math.max(range_m * NEAREST_SHARE, range_m - own_mps * (timeAt(k, clip) - timeAt(first, clip)));
  const xAt = (k: number) => at[0] + direction * rate_px_s * (timeAt(k, clip) - timeAt(frame, clip));
  // So high above the horizon that the height is that of the frame shown.
  const pixelAt = (k: number): Point => {
    const [here, then] = [frame, k].map((one) => plan && horizonAt(plan, one, xAt(one)));
    if (!plan || here === null || then === null) return [xAt(k), at[1]];
    const m_per_px = (one: number, y: number) =>
        rangeAt(one) / Math.hypot(focal_px, xAt(one) - clip.width / 2, y - clip.height / 2);
    const [down, downThen] = [frame, k].map((one) => nedAt(plan, plan.own.ned, one)?.[2] ?? 0);
    const above_m = (here - at[1]) * m_per_px(frame, at[1]) + downThen - down;
    let y = at[1];
    for (let round = 0; k !== frame && round < 8; ++round) y = then - above_m / m_per_px(k, y);
    return [xAt(k), y];
  };
  const seen = [first, last].map((k) => seenTable(timeOf(k, clip), pixelAt(k), rangeAt(k)));
  if (choice.kind === 'aircraft') return {aircraft: choice.aircraft ?? '', seen};
  const flock: Table = isFlock ? {count: choice.count!, spread_m: round(choice.length_m * 6, 0)} : {};
  return {kind: choice.kind, ...flock, seen};
}

// Beside the one it is copied from, and with no id of its own.
export function copyOf(flyer: Flyer, clip: Clip): Table {
  const {id: _, ...table} = structuredClone(flyer.table);
  const aside = Math.round(clip.height * 0.06);
  for (const seen of tables(table.seen))
    if (Array.isArray(seen.pixel)) seen.pixel = writtenPixel([Number(seen.pixel[0]), Number(seen.pixel[1]) + aside]);
  for (const place of [table.position_ned_m, ...(Array.isArray(table.waypoints_ned_m) ? table.waypoints_ned_m : [])])
    if (Array.isArray(place)) place[2] = Number(place[2]) - 20;
  const encounter = tableOf(table.encounter);
  if ('encounter' in table) encounter.cpa_above_m = (numberOf(encounter.cpa_above_m) ?? 0) + 20;
  return table;
}

export function ownSpeed(plan: Plan, frame: number, clip: Clip): number {
  const own = velocityAt(plan, plan.own.ned, frame, clip);
  return own ? Math.hypot(own[0], own[1]) : 0;
}

// Of an encounter, from the own course; head-on where it states none.
export const statedCourse = (flyer: Flyer) => numberOf(tableOf(flyer.table.encounter).course_deg) ?? 180;

// Below it the place across follows from `cpa_ahead_m`, not from `cpa_right_m`: a choice.
const LEAST_ACROSS = 0.2;

// Where the closest approach of an encounter can lie, in [right, ahead] of the own course: at any distance along
// `across`, which is across the relative velocity. `back` is the part along that velocity, which follows from the
// height where the two do not stay at one height.
export interface Across {
  across: Point;
  back: Point;
}

export function acrossOf(flyer: Flyer, plan: Plan, clip: Clip): Across {
  const encounter = tableOf(flyer.table.encounter);
  const number = (key: string) => numberOf(encounter[key]) ?? 0;
  const frame = frameAt(number('cpa_time_s'), clip);
  const [climb_mps, own] = [number('climb_mps'), velocityAt(plan, plan.own.ned, frame, clip)];
  const relative = relativeOf(ownSpeed(plan, frame, clip), number('speed_mps'), climb_mps, statedCourse(flyer));
  const length = Math.hypot(...relative);
  if (length < 1e-6) return {across: [1, 0], back: [0, 0]};
  const back = (-heightOf(flyer) * (climb_mps + (own?.[2] ?? 0))) / length ** 2;
  return {across: [-relative[1] / length, relative[0] / length], back: [back * relative[0], back * relative[1]]};
}

export function setAcross(flyer: Flyer, {across, back}: Across, along_m: number): Change[] {
  const isRight = Math.abs(across[0]) >= LEAST_ACROSS;
  const [key, other] = isRight ? ['cpa_right_m', 'cpa_ahead_m'] : ['cpa_ahead_m', 'cpa_right_m'];
  const axis = isRight ? 0 : 1;
  const set: Change = {set: [...flyer.path, 'encounter', key], to: round(along_m * across[axis] + back[axis], 1)};
  return other in tableOf(flyer.table.encounter) ? [{remove: [...flyer.path, 'encounter', other]}, set] : [set];
}

function alongOf(flyer: Flyer, {across, back}: Across): number {
  const {cpa_right_m, cpa_ahead_m} = tableOf(flyer.table.encounter);
  const axis = cpa_ahead_m !== undefined && cpa_right_m === undefined ? 1 : 0;
  const rest = (numberOf(axis ? cpa_ahead_m : cpa_right_m) ?? 0) - back[axis];
  return Math.abs(rest) < 1e-9 ? 0 : rest / across[axis];
}

const heightOf = (flyer: Flyer) => numberOf(tableOf(flyer.table.encounter).cpa_above_m) ?? 0;

// The miss distance of an encounter, the least that it can have at its height, and another one on the same side.
export function missOf(flyer: Flyer, plan: Plan, clip: Clip): {miss_m: number; least_m: number} {
  const where = acrossOf(flyer, plan, clip);
  const least_m = Math.hypot(heightOf(flyer), ...where.back);
  return {miss_m: Math.hypot(alongOf(flyer, where), least_m), least_m};
}
export function withMiss(flyer: Flyer, plan: Plan, clip: Clip, miss_m: number): Change[] {
  const where = acrossOf(flyer, plan, clip);
  const along_m = Math.sqrt(Math.max(0, miss_m ** 2 - missOf(flyer, plan, clip).least_m ** 2));
  return setAcross(flyer, where, (alongOf(flyer, where) || where.across[0]) < 0 ? -along_m : along_m);
}

// Another course at the same miss distance and on the same side. `begin`: the flyer whose they are.
export function withCourse(flyer: Flyer, plan: Plan, clip: Clip, course_deg: number, begin = flyer): Change[] {
  const before = acrossOf(begin, plan, clip);
  const isRight = alongOf(begin, before) * before.across[0] >= 0;
  const turned: Flyer = {...flyer, table: {...flyer.table, encounter: {...tableOf(flyer.table.encounter), course_deg}}};
  const {across, back} = acrossOf(turned, plan, clip);
  const {miss_m} = missOf(begin, plan, clip);
  const along_m = Math.sqrt(Math.max(0, miss_m ** 2 - heightOf(flyer) ** 2 - Math.hypot(...back) ** 2));
  return [
    {set: [...flyer.path, 'encounter', 'course_deg'], to: course_deg},
    ...setAcross(flyer, {across, back}, across[0] >= 0 === isRight ? along_m : -along_m)
  ];
}

// How long a flyer is in view, as well as the plan's frames tell.
export function describedView({points}: Track, plan: Plan, clip: Clip): string {
  const seen = points.filter((point) => point[5]).map(([frame]) => frame);
  if (!seen.length) return '';
  const step = plan.frames.length > 1 ? plan.frames[1] - plan.frames[0] : 1;
  const lasts_s = seen.reduce(
      (sum, frame, k) => sum + timeAt(Math.min(frame + step, seen[k + 1] ?? clip.frames), clip) - timeAt(frame, clip),
      0);
  const [from_s, to_s] = [seen[0], seen[seen.length - 1]].map((frame) => round(timeAt(frame, clip), 1));
  return `In view for ${round(lasts_s, 1)} s, between ${from_s} and ${to_s} s.`;
}

export const describedApproach = (cpa: Approach) => `closest at ${round(cpa.time_s, 1)} s: ${
    round(cpa.distance_m, 0)} m, ${side(cpa.right_m, 'right', 'left')}, ${side(cpa.above_m, 'above', 'below')}`;
const side = (value: number, positive: string, negative: string) =>
    `${Math.abs(round(value, 0))} m ${value >= 0 ? positive : negative}`;
