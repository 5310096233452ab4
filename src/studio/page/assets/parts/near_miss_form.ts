// SPDX-License-Identifier: Apache-2.0
import type {Flyer} from '../model/flyers';
import {round} from '../model/geometry';
import type {Studio} from '../model/studio';
import {NumberField, choiceField} from './fields';
import {h, text} from './part';

const USUAL_MISS_M = 100;
const [MOST_MISS_M, LEAST_MPS, MOST_MPS] = [1e5, 1e-3, 1e4];  // of a scene's numbers (src/scene/scene/limits.h)

// Lets a path that is stated by moments go on level from one of them, past the own aircraft at a stated distance.
export class NearMissForm {
  readonly element: HTMLElement;
  private miss_m = USUAL_MISS_M;
  private speed_mps = 0;  // 0: that of the path
  private moment = 0;
  private pathMps = 0;
  private miss = new NumberField({
    label: 'Miss distance',
    unit: 'm',
    step: 10,
    min: 0,
    max: MOST_MISS_M,
    taken:
        (value) => {
          this.miss_m = value;
        }
  });
  private speed = new NumberField({
    label: 'Speed',
    unit: 'm/s',
    step: 5,
    min: LEAST_MPS,
    max: MOST_MPS,
    taken:
        (value) => {
          this.speed_mps = value;
        }
  });
  private side = choiceField('Passes on the', [['right', 'right'], ['left', 'left']], () => {});
  private words = h('p', {class: 'hint'});

  constructor(private studio: Studio) {
    this.element =
        h('details', {class: 'near-miss'}, h('summary', {}, 'Near miss …'), this.words,
          h('div', {class: 'grid'}, this.miss.element, this.side.element, this.speed.element),
          h('div', {class: 'actions'}, h('button', {onclick: () => this.ask()}, 'Fly past')));
  }

  // `pathMps`: how fast the path is at that moment, where it is known.
  show(flyer: Flyer, moment: number, time_s: number, pathMps: number|null): void {
    this.moment = moment;
    this.pathMps = pathMps ?? this.pathMps;
    this.miss.show(this.miss_m);
    this.speed.show(this.speed_mps || round(this.pathMps, 0) || null);
    text(
        this.words,
        `${flyer.id} stays at its pixel at ${round(time_s, 2)} s and flies level from there, past the own aircraft.`);
  }

  private ask(): void {
    const speed_mps = this.speed_mps || round(this.pathMps, 0);
    if (speed_mps) void this.studio.nearMiss(this.moment, this.miss_m, this.side.select.value === 'right', speed_mps);
  }
}
