// SPDX-License-Identifier: Apache-2.0
import type {BoxPx, Clip, Ned, Plan, Track, TrackPoint} from './contract';

export type Point = [number, number];

export const clamp = (value: number, low: number, high: number) => Math.min(high, Math.max(low, value));
export const mix = (a: number, b: number, share: number) => a + (b - a) * share;
export const round = (value: number, decimals: number) => Number(value.toFixed(decimals));
export const degrees = (radians: number) => (radians * 180) / Math.PI;
export const radians = (deg: number) => (deg * Math.PI) / 180;
// To 0 up to 360.
export const turned = (deg: number) => ((deg % 360) + 360) % 360;

const meet = (a: BoxPx, b: BoxPx) =>
    a[0] < b[0] + b[2] && b[0] < a[0] + a[2] && a[1] < b[1] + b[3] && b[1] < a[1] + a[3];
const isInside = (a: BoxPx, room: BoxPx) =>
    a[0] >= room[0] && a[1] >= room[1] && a[0] + a[2] <= room[0] + room[2] && a[1] + a[3] <= room[1] + room[3];

// Where something of a size stands: at the first place in the room that meets nothing of what is taken, else at the
// first, moved into the room.
export function freePlace([w, h]: Point, places: Point[], room: BoxPx, taken: BoxPx[]): BoxPx {
  const boxes = places.map(([x, y]): BoxPx => [x, y, w, h]);
  const [x, y] = places[0];
  return boxes.find((box) => isInside(box, room) && !taken.some((one) => meet(one, box))) ?? [
    clamp(x, room[0], Math.max(room[0], room[0] + room[2] - w)),
    clamp(y, room[1], Math.max(room[1], room[1] + room[3] - h)), w, h
  ];
}

export interface Seen {
  pixel: Point;
  range_m: number;
}

export const isPlaced = (point: TrackPoint): point is[number, number, number, number, number | null, boolean] =>
    point[1] !== null && point[2] !== null;
const seenOf = (point: TrackPoint): Seen|null =>
    (isPlaced(point) ? {pixel: [point[1], point[2]], range_m: point[3]} : null);

// Where a track is in a frame: its points in order of their frames, and what lies between two by straight lines. Beyond
// its ends it is not there.
export function seenAt(track: Track, frame: number): Seen|null {
  const {points} = track;
  if (!points.length || frame < points[0][0] || frame > points[points.length - 1][0]) return null;
  let low = 0;
  let high = points.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (points[middle][0] <= frame)
      low = middle;
    else
      high = middle;
  }
  const [a, b] = [points[low], points[high]];
  const share = b[0] > a[0] ? (frame - a[0]) / (b[0] - a[0]) : 0;
  const [from, to] = [seenOf(a), seenOf(b)];
  if (!from || !to) return share < 0.5 ? from : to;
  const pixel: Point = [mix(from.pixel[0], to.pixel[0], share), mix(from.pixel[1], to.pixel[1], share)];
  return {pixel, range_m: mix(from.range_m, to.range_m, share)};
}

// The same, going on straight beyond the ends; none of a track without points.
export function seenNear(track: Track, frame: number): Seen|null {
  const inside = seenAt(track, frame);
  if (inside || !track.points.length) return inside;
  const isBefore = frame < track.points[0][0];
  return seenOf(isBefore ? track.points[0] : track.points[track.points.length - 1]);
}

const nedMix =
    (a: Ned, b: Ned, share: number): Ned => [mix(a[0], b[0], share), mix(a[1], b[1], share), mix(a[2], b[2], share)];

// A place among those at the plan's frames. Outside of them it goes on straight.
export function nedAt(plan: Plan, ned: (Ned|null)[], frame: number): Ned|null {
  const known = plan.frames.flatMap((f, k) => (ned[k] ? [{f, ned: ned[k]!}] : []));
  if (!known.length) return null;
  if (known.length === 1) return known[0].ned;
  let k = known.findIndex((one) => one.f >= frame);
  k = clamp(k < 0 ? known.length - 1 : k, 1, known.length - 1);
  const [a, b] = [known[k - 1], known[k]];
  return nedMix(a.ned, b.ned, (frame - a.f) / (b.f - a.f));
}

// The time of a frame, also between two, and the frame of a time. Beyond the clip they go on by the rate.
export function timeAt(frame: number, {times_s, rate_hz}: Clip): number {
  const last = times_s.length - 1;
  if (last < 1 || frame <= 0) return frame / rate_hz;
  if (frame >= last) return times_s[last] + (frame - last) / rate_hz;
  const k = Math.floor(frame);
  return mix(times_s[k], times_s[k + 1], frame - k);
}
export function frameAt(time_s: number, {times_s, rate_hz}: Clip): number {
  const last = times_s.length - 1;
  if (last < 1 || time_s <= 0) return time_s * rate_hz;
  if (time_s >= times_s[last]) return last + (time_s - times_s[last]) * rate_hz;
  const k = times_s.findIndex((one) => one > time_s) - 1;
  return k + (time_s - times_s[k]) / (times_s[k + 1] - times_s[k]);
}

// Metres a second, north-east-down.
export function velocityAt(plan: Plan, ned: (Ned|null)[], frame: number, clip: Clip): Ned|null {
  const [a, b] = [nedAt(plan, ned, frame - 0.5), nedAt(plan, ned, frame + 0.5)];
  const lasts_s = timeAt(frame + 0.5, clip) - timeAt(frame - 0.5, clip);
  return a && b ? [(b[0] - a[0]) / lasts_s, (b[1] - a[1]) / lasts_s, (b[2] - a[2]) / lasts_s] : null;
}

export const courseOf = (velocity: Ned) => degrees(Math.atan2(velocity[1], velocity[0]));
export const speedOf = (velocity: Ned) => Math.hypot(...velocity);

// The horizontal velocity of an encounter's aircraft relative to the own one, as [right, ahead] of the own course.
export function relativeOf(own_mps: number, speed_mps: number, climb_mps: number, course_deg: number): Point {
  const ground = Math.sqrt(Math.max(0, speed_mps * speed_mps - climb_mps * climb_mps));
  return [ground * Math.sin(radians(course_deg)), ground * Math.cos(radians(course_deg)) - own_mps];
}
