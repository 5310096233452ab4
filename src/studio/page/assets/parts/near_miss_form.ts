// SPDX-License-Identifier: Apache-2.0
import type {NearMiss} from '../model/contract';
import {type Flyer, MOST_MISS_M, SPEEDS_MPS} from '../model/flyers';
import {clamp, round} from '../model/geometry';
import type {Studio} from '../model/studio';
import {NumberField, choiceField} from './fields';
import {h, text} from './part';

const USUAL: NearMiss = {
  miss_m: 100,
  right: true,
  speed_mps: 0,  // that of the path
  above_m: 0
};
const MOST_USUAL_MPS = 250;  // of an airliner; a path that is still being made may be faster

// Lets a path go on straight from the frame shown, past the own aircraft at a stated distance.
export class NearMissForm {
  readonly element: HTMLElement;
  private wanted = USUAL;
  private of = '';  // whose numbers these are
  private miss = new NumberField(
      {label: 'Pass at', unit: 'm', step: 10, min: 0, max: MOST_MISS_M}, (value) => this.take({miss_m: value}));
  private above = new NumberField(
      {
        label: 'Above',
        unit: 'm',
        step: 10,
        min: -MOST_MISS_M,
        max: MOST_MISS_M,
        placeholder: 'flies level',
        emptied: () => this.take({above_m: null})
      },
      (value) => this.take({above_m: value}));
  private speed = new NumberField(
      {label: 'Speed', unit: 'm/s', step: 5, min: SPEEDS_MPS[0], max: SPEEDS_MPS[1]},
      (value) => this.take({speed_mps: value}));
  private side =
      choiceField('On the', [['right', 'right'], ['left', 'left']], (side) => this.take({right: side === 'right'}));
  private words = h('p', {class: 'hint'});
  private button = h('button', {onclick: () => void this.studio.nearMiss(this.wanted)});

  constructor(private studio: Studio) {
    const fields = [this.miss, this.side, this.above, this.speed].map((one) => one.element);
    this.element =
        h('details', {class: 'near-miss'}, h('summary', {}, 'Near miss …'), this.words,
          h('div', {class: 'grid'}, ...fields), h('div', {class: 'actions'}, this.button));
  }

  // `path_mps`: how fast the path is in the frame shown, where it is known.
  show(flyer: Flyer, time_s: number, path_mps: number|null): void {
    const of = JSON.stringify(flyer.path);
    if (of !== this.of) this.wanted = USUAL;
    this.of = of;
    if (!this.wanted.speed_mps && path_mps)
      this.wanted = {...this.wanted, speed_mps: round(clamp(path_mps, 1, MOST_USUAL_MPS), 0)};
    this.showNumbers();
    const at = `${round(time_s, 2)} s`;
    text(
        this.words,
        `From its pixel in the frame shown, at ${at}, ${
            flyer.id} flies straight on, past you. Its path is then stated by its closest approach.`);
    text(this.button, `Fly past from ${at} on`);
  }

  private take(part: Partial<NearMiss>): void {
    this.wanted = {...this.wanted, ...part};
    this.showNumbers();
  }

  private showNumbers(): void {
    const {miss_m, right, above_m, speed_mps} = this.wanted;
    this.side.select.value = right ? 'right' : 'left';
    this.miss.show(miss_m);
    this.above.show(above_m);
    this.speed.show(speed_mps || null);
  }
}
