// SPDX-License-Identifier: Apache-2.0
import type { Track } from './contract';
import { type Point, isPlaced, seenAt } from './geometry';

const WINDOW_S = 0.45;
const NEAR_S = 0.25; // about the frame shown, where the line goes through the place in that very frame
const LEAST_POINTS = 5;

// A track's pixels without the shake of the camera, which makes a line through the pixels of all frames a zigzag: at each frame the
// value of the parabola that fits the frames around it best.
export function steadied(track: Track, rate_hz: number): (Point | null)[] {
  const { points } = track;
  const reach = WINDOW_S * rate_hz;
  let from = 0;
  return points.map((point) => {
    if (!isPlaced(point)) return null;
    while (points[from][0] < point[0] - reach) ++from;
    const around: [number, number, number, number][] = []; // time, weight, x, y
    for (let k = from; k < points.length && points[k][0] <= point[0] + reach; ++k) {
      const other = points[k];
      if (!isPlaced(other)) continue;
      const t = (other[0] - point[0]) / reach;
      around.push([t, (1 - t * t) ** 2 + 1e-3, other[1], other[2]]);
    }
    return around.length < LEAST_POINTS ? [point[1], point[2]] : [middleOfParabola(around, 2), middleOfParabola(around, 3)];
  });
}

// The value at the time 0 of the weighted least-squares parabola.
function middleOfParabola(around: [number, number, number, number][], of: 2 | 3): number {
  const moment = [0, 0, 0, 0, 0];
  const value = [0, 0, 0];
  for (const one of around) {
    let power = one[1];
    for (let k = 0; k < 5; ++k) {
      moment[k] += power;
      if (k < 3) value[k] += power * one[of];
      power *= one[0];
    }
  }
  const determinant = (a: number, b: number, c: number, d: number, e: number, f: number, g: number, h: number, i: number) => a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
  const [m0, m1, m2, m3, m4] = moment;
  const whole = determinant(m0, m1, m2, m1, m2, m3, m2, m3, m4);
  return Math.abs(whole) < 1e-9 ? value[0] / m0 : determinant(value[0], m1, m2, value[1], m2, m3, value[2], m3, m4) / whole;
}

// A line while one of its moments is dragged, until the server says how it goes: what lies between the moments beside it follows.
export function bent(track: Track, line: (Point | null)[], frames: number[], index: number, by: Point): (Point | null)[] {
  const middle = frames[index];
  const first = track.points.length ? track.points[0][0] : 0;
  const last = track.points.length ? track.points[track.points.length - 1][0] : 0;
  return line.map((point, k) => {
    const frame = track.points[k][0];
    const isBefore = frame < middle;
    const other = isBefore ? frames[index - 1] ?? first - 1 : frames[index + 1] ?? last + 1;
    const away = Math.abs(other - middle) > 0 ? (frame - middle) / (other - middle) : 0;
    const share = away >= 1 || frame === other ? 0 : (1 + Math.cos(Math.PI * away)) / 2;
    return point && [point[0] + by[0] * share, point[1] + by[1] * share];
  });
}

// The same, bent so that it goes through the place in the frame shown.
export function through(track: Track, steady: (Point | null)[], frame: number, rate_hz: number): (Point | null)[] {
  const seen = seenAt(track, frame);
  const there = seen && seenAt({ ...track, points: track.points.map((point, k) => [point[0], steady[k]?.[0] ?? null, steady[k]?.[1] ?? null, point[3], point[4], point[5]]) }, frame);
  if (!seen || !there) return steady;
  const [dx, dy] = [seen.pixel[0] - there.pixel[0], seen.pixel[1] - there.pixel[1]];
  return steady.map((point, k) => {
    const share = Math.exp(-(((track.points[k][0] - frame) / (NEAR_S * rate_hz)) ** 2));
    return point && [point[0] + dx * share, point[1] + dy * share];
  });
}
