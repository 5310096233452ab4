// SPDX-License-Identifier: Apache-2.0
import type { Track } from '../model/contract';
import { flyersOf, isSame, reachOf } from '../model/flyers';
import { type Seen, nedAt, round, seenAt } from '../model/geometry';
import type { Everything } from '../model/store';
import { Keyed, attribute, s, text } from './part';

const MOTION_FRAMES = 30;

interface Box {
  track: Track;
  seen: Seen;
  colour: number;
  isSelected: boolean;
  reach_px: number;
}

// What is measured or follows, drawn over the frame: boxes with range and size, the horizon, and how it moved lately.
export class OverlayLayer {
  readonly element = s('g', { class: 'overlay' });
  private horizon = s('line', { class: 'horizon' });
  private motion = s('g', { class: 'motion' });
  private scale = 1;
  private boxes: Keyed<Box, SVGGElement>;

  constructor() {
    const boxes = s('g');
    this.element.append(this.motion, this.horizon, boxes);
    this.boxes = new Keyed<Box, SVGGElement>(boxes, () => s('g', {}, s('path'), s('text')), (element, box) => this.renew(element, box));
  }

  update(now: Readonly<Everything>, scale: number): void {
    this.scale = scale;
    this.showHorizon(now);
    this.showMotion(now);
    const { plan, state, frame, showsBoxes } = now;
    const flyers = state ? flyersOf(state.scene) : [];
    const boxes = (showsBoxes ? plan?.tracks ?? [] : []).flatMap((track) => {
      const seen = seenAt(track, frame);
      const flyer = flyers.find((one) => isSame(one.path, track.table));
      if (!seen || !flyer || !seen.isVisible) return [];
      const item = { track, seen, colour: flyer.colour, isSelected: isSame(now.selected, track.table), reach_px: reachOf(flyer, seen.width_px) };
      return [{ key: JSON.stringify(track.table), item }];
    });
    this.boxes.show(boxes);
  }

  private renew(element: SVGGElement, { track, seen, colour, isSelected }: Box): void {
    attribute(element, 'class', `box colour-${colour}${isSelected ? ' selected' : ''}`);
    const [path, label] = [element.children[0], element.children[1]];
    const px = 1 / this.scale;
    const half = [seen.width_px / 2 + 4 * px, Math.max(seen.width_px / 3.2, 8 * px)];
    const [x0, x1, y0, y1] = [seen.pixel[0] - half[0], seen.pixel[0] + half[0], seen.pixel[1] - half[1], seen.pixel[1] + half[1]];
    const arm = Math.min(12 * px, half[0] / 1.5, half[1] / 1.5);
    const corner = (x: number, y: number, dx: number, dy: number) => `M${x + dx * arm},${y}H${x}V${y + dy * arm}`;
    attribute(path, 'd', corner(x0, y0, 1, 1) + corner(x1, y0, -1, 1) + corner(x0, y1, 1, -1) + corner(x1, y1, -1, -1));
    attribute(label, 'x', x1 + 6 * px);
    attribute(label, 'y', y0 - 2 * px);
    attribute(label, 'font-size', 13 * px);
    text(label, `${track.id}  ${distance(seen.range_m)}  ${round(seen.width_px, 1)} px`);
  }

  private showHorizon({ plan, frame, showsHorizon }: Readonly<Everything>): void {
    const line = showsHorizon && plan ? nearest(plan.horizon, frame) : null;
    this.horizon.toggleAttribute('hidden', !line);
    if (line) for (const [k, name] of ['x1', 'y1', 'x2', 'y2'].entries()) attribute(this.horizon, name, line[k]);
  }

  // The horizon of the frames just before, fading: how the own aircraft turned. And the own speed in words.
  private showMotion({ plan, clip, frame, showsMotion }: Readonly<Everything>): void {
    this.motion.replaceChildren();
    if (!showsMotion || !plan || !clip) return;
    const lines = plan.horizon.filter(([k]) => k <= frame && k > frame - MOTION_FRAMES);
    lines.forEach(([, [x1, y1, x2, y2]], k) => this.motion.append(s('line', { x1, y1, x2, y2, opacity: round(0.1 + (0.5 * k) / Math.max(1, lines.length), 2) })));
    const [a, b] = [nedAt(plan, plan.own.ned, frame), nedAt(plan, plan.own.ned, frame + 1)];
    if (!a || !b) return;
    const px = 1 / this.scale;
    const speed_mps = Math.hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]) * clip.rate_hz;
    const label = s('text', { x: 10 * px, y: clip.height - 10 * px, 'font-size': 13 * px });
    label.textContent = `own speed ${round(speed_mps, 1)} m/s, height ${round(-a[2], 0)} m`;
    this.motion.append(label);
  }
}

export const distance = (range_m: number) => (range_m < 9950 ? `${range_m < 100 ? round(range_m, 1) : Math.round(range_m)} m` : `${round(range_m / 1000, 1)} km`);

function nearest<Value>(all: [number, Value][], frame: number): Value | null {
  const best = all.reduce<[number, Value] | null>((found, one) => (!found || Math.abs(one[0] - frame) < Math.abs(found[0] - frame) ? one : found), null);
  return best ? best[1] : null;
}
