// SPDX-License-Identifier: Apache-2.0
import type {Change, Json, Ned, Plan, Table} from '../model/contract';
import {numberOf, tableOf} from '../model/flyers';
import {round} from '../model/geometry';
import type {Member} from '../model/store';
import {NumberField, type NumberOptions} from './fields';
import {Part, button, h, text} from './part';

interface Row {
  field: NumberField;
  value: (scene: Table) => number | null;
}

const [MOST_M, MOST_MPS] = [1e9, 1e4];  // of a scene
const ANGLES = ['Yaw', 'Pitch', 'Roll'];
const numbers = (value: Json|undefined, usual: number[]): number[] =>
    (Array.isArray(value) && value.length === usual.length ? value.map(Number) : usual);

// Sets one number of a triple of the camera's.
const setsPart = (key: string, k: number, usual = [0, 0, 0]) => (value: number, scene: Table): Change[] =>
    [{set: ['camera', key], to: numbers(tableOf(scene.camera)[key], usual).map((old, i) => (i === k ? value : old))}];

// The lens and the attitude of the camera; the horizon that follows from them is drawn over the frame while this is
// shown.
export class CameraPanel extends Part {
  protected readonly watches: Member[] = ['state', 'plan', 'planProblem', 'clip'];
  private rows: Row[] = [];
  private used = h('p', {class: 'hint'});
  private origin = h('p', {class: 'hint'});
  private found = h('p', {class: 'hint'});
  private flight = h('p', {class: 'hint'});
  private forget = button(
      'Measure attitude from the horizon',
      () => this.studio.edit([{remove: ['camera', 'attitude_yaw_pitch_roll_deg']}]));

  protected build(): void {
    const lens = this.row(
        {label: 'Vertical view', unit: '°', step: 0.5, min: 0.01, max: 359},
        (scene) => numberOf(tableOf(scene.lens).vertical_fov_deg),
        (value) => [{set: ['lens', 'vertical_fov_deg'], to: value}]);
    const angles = ANGLES.map(
        (label, k) => this.row(
            {
              label,
              unit: '°',
              step: 0.1,
              min: k === 1 ? -90 : -360,
              max: k === 1 ? 90 : 360,
              placeholder: 'not stated'
            },
            (scene) => this.inForce(scene, 'attitude_yaw_pitch_roll_deg', k, (own) => own.attitude_deg),
            (value, scene) =>
                setsPart('attitude_yaw_pitch_roll_deg', k, this.now.plan?.own.attitude_deg)(value, scene)));
    const height = this.row({label: 'Height', unit: 'm', step: 1, min: -MOST_M, max: MOST_M}, (scene) => {
      const down_m = this.inForce(scene, 'position_ned_m', 2, (own) => own.ned[0], -150);
      return down_m === null ? null : -down_m;
    }, (value, scene) => setsPart('position_ned_m', 2, [0, 0, -150])(-value, scene));
    const velocity = ['North', 'East', 'Down'].map(
        (label, k) => this.row(
            {label, unit: 'm/s', step: 1, min: -MOST_MPS, max: MOST_MPS},
            (scene) => this.inForce(scene, 'velocity_ned_mps', k, (own) => own.velocity_mps, 0),
            setsPart('velocity_ned_mps', k)));
    this.append(
        h('h2', {}, 'Clip'), this.used, h('h2', {}, 'Lens'), h('div', {class: 'grid'}, lens), this.origin,
        h('h2', {}, 'Attitude in the first frame'), h('div', {class: 'grid three'}, ...angles),
        h('p', {class: 'hint'}, 'The line over the frame is where lens and attitude put the horizon.'), this.found,
        h('div', {class: 'actions'}, this.forget), h('h2', {}, 'Own flight'), h('div', {class: 'grid'}, height),
        h('div', {class: 'grid three'}, ...velocity), this.flight);
  }

  protected update(): void {
    const {state, plan, planProblem, clip} = this.now;
    if (!state) return;
    const {scene, notes} = state;
    // The file's own words on where its numbers come from.
    const said = (...keys: string[]) => keys.map((key) => notes[key]).filter(Boolean).join('; ');
    text(
        this.used,
        clip ? `${clip.frames} frames are used, from ${clip.begin_s.toFixed(2)} s of the video on. ${
                   said('background.first_frame', 'background.frame_count')}` :
               '');
    for (const {field, value} of this.rows) field.show(value(scene));
    const lens = tableOf(scene.lens);
    const hasFov = 'vertical_fov_deg' in lens;
    text(
        this.origin,
        'file' in lens ? `The lens is that of ${String(lens.file)}.` :
            Array.isArray(lens.focal_px) ?
                         `Focal lengths ${lens.focal_px.map((px) => round(Number(px), 1)).join(', ')} px.` :
                         said('lens', 'lens.model', 'lens.vertical_fov_deg'));
    const camera = tableOf(scene.camera);
    const isFile = 'path_file' in camera;
    const by = isFile || 'log' in camera ? `What is not stated is by the ${isFile ? 'path file' : 'log'}.` : '';
    text(this.found, plan?.own.attitude || by || said('camera', 'camera.attitude_yaw_pitch_roll_deg'));
    text(this.flight, by ? `In the first frame. ${by}` : said('camera.position_ned_m', 'camera.velocity_ned_mps'));
    this.rows[0].field.input.disabled = !hasFov;
    this.rows.slice(1).forEach(({field}) => {
      field.input.disabled = isFile;
    });
    // One angle that is entered states all three: the other two are the plan's.
    this.rows.slice(1, 4).forEach(({field}) => {
      field.input.disabled = isFile || !(plan || planProblem || 'attitude_yaw_pitch_roll_deg' in camera);
    });
    this.rows.slice(5).forEach(({field}) => {
      field.input.disabled = isFile || 'log' in camera;
    });
    this.forget.disabled = !('attitude_yaw_pitch_roll_deg' in camera);
  }

  // One number of a triple of the camera's: as stated, else by its log or path file in the first frame, else as usual.
  private inForce(scene: Table, key: string, k: number, flown: (own: Plan['own']) => Ned, usual: number|null = null):
      number|null {
    const camera = tableOf(scene.camera);
    const stated = camera[key];
    if (Array.isArray(stated)) return Number(stated[k]);
    if (!('log' in camera || 'path_file' in camera)) return usual;
    const {plan} = this.now;
    return plan ? flown(plan.own)[k] : null;
  }

  private row(
      options: NumberOptions, value: (scene: Table) => number | null,
      changes: (value: number, scene: Table) => Change[]): HTMLElement {
    const field = new NumberField(options, (taken) => {
      if (this.now.state) this.studio.edit(changes(taken, this.now.state.scene));
    });
    this.rows.push({field, value});
    return field.element;
  }
}
customElements.define('studio-camera', CameraPanel);
