// SPDX-License-Identifier: Apache-2.0
import type {Json, MeasuredValue} from '../model/contract';
import {numberOf, tableOf} from '../model/flyers';
import {type Point, clamp, degrees, radians, round, turned} from '../model/geometry';
import type {Member} from '../model/store';
import {NumberField, Slider, type SliderOptions, tick} from './fields';
import {Part, arrow, attribute, button, h, s} from './part';

const RADIUS = 90;
const SUN: [string, number, number, number][] =
    [['sun_azimuth_deg', 180, -360, 360], ['sun_elevation_deg', 45, -90, 90]];
const KOSCHMIEDER = Math.log(50);  // visibility in km is this over the extinction in 1/km

// The unit that a key's name ends with.
const UNITS: Record<string, string> = {
  px: 'px',
  s: 's',
  deg: '°',
  per_km: '1/km'
};
const unitIn = (key: string) => Object.keys(UNITS).find((unit) => key.endsWith(`_${unit}`)) ?? '';
const unitOf = (key: string) => UNITS[unitIn(key)] ?? '';
// "sensor.noise_correlation_px": noise correlation
const nameOf = (key: string) => key.replace(/^.*\./, '').replace(new RegExp(`_${unitIn(key)}$`), '').replace(/_/g, ' ');
// Four digits of a number, or of each.
const short = (value: Json): Json =>
    (Array.isArray(value)          ? value.map(short) :
         typeof value === 'number' ? Number(value.toPrecision(4)) :
                                     value);

interface WeatherKey extends SliderOptions {
  key: string;
  on?: [string, RegExp];  // the table and the keys that it is a factor on
}
const factor = (value: number) => `× ${Number(value.toPrecision(3))}`;
const WEATHER: WeatherKey[] = [
  {key: 'exposure', label: 'Light', min: 0.0625, max: 16, isLogarithmic: true, shown: factor},
  {key: 'white_balance', label: 'Red to blue', min: 0.25, max: 4, isLogarithmic: true, shown: factor},
  {key: 'sun_share', label: 'Sun', min: 0, max: 1, shown: (v) => (v === 0 ? 'hidden' : `${Math.round(v * 100)} %`)},
  {key: 'blur', label: 'Blur', min: 0, max: 10, shown: factor, on: ['optics', /^point_spread_px$/]},
  {key: 'noise', label: 'Noise', min: 0, max: 10, shown: factor, on: ['sensor', /^noise_(gain|floor)$/]},
];

// The sun on a dome seen from above, weather, and what is measured from the clip.
export class LightPanel extends Part {
  protected readonly watches: Member[] = ['state', 'plan', 'busy', 'measured', 'clip'];
  private sun = s('circle', {class: 'sun', r: 9});
  private dome = s('svg', {
    class: 'dome',
    viewBox: '-120 -112 240 224',
    tabindex: 0,
    role: 'slider',
    'aria-label': 'The sun. Arrow keys turn and raise it'
  });
  private view = s('path', {class: 'view'});
  private fields: NumberField[] = [];
  private sliders: Slider[] = [];
  private haze!: Slider;
  private auto = tick('Measure blur, noise and haze from the clip', (isOn) => this.auto_(isOn));
  private calibrate = button('Calibrate', () => void this.studio.calibrate());
  private values = h('table', {class: 'values'});
  private use = button('Put these values into the scene', () => this.useMeasured());
  private merge = '';
  private isHeld = false;
  private isHazeMeasured = false;  // where none is stated

  protected build(): void {
    this.buildDome();
    this.fields = SUN.map(([key, , min, max]) => {
      const label = key === SUN[0][0] ? 'Azimuth from north' : 'Elevation';
      return new NumberField(
          {label, unit: '°', step: 1, min, max}, (value) => this.studio.edit([{set: ['light', key], to: value}]));
    });
    this.sliders =
        WEATHER.map((one) => this.slider(one, (value) => [['weather', one.key], value === 1 ? null : value]));
    this.haze = this.slider(
        {
          label: 'Visibility',
          min: 1,
          max: 200,
          isLogarithmic: true,
          shown: (km) =>
              (km < 200 ? `${round(km, 1)} km` :
                   this.isHazeMeasured ? 'measured' :
                                         'clear')
        },
        (km) => [['air', 'extinction_per_km'], km >= 200 ? null : [1, 1, 1].map(() => round(KOSCHMIEDER / km, 4))]);
    this.append(
        h('h2', {}, 'Sun'), this.dome, h('div', {class: 'grid'}, ...this.fields.map((one) => one.element)),
        h('h2', {}, 'Weather of what is inserted'), ...this.sliders.map((one) => one.element), this.haze.element,
        h('p', {class: 'hint'},
          'The clip’s own picture stays as it is. Blur and noise are factors on the camera’s own, which are measured with the tick below.'),
        h('h2', {}, 'As this camera sees'), this.auto.element, h('div', {class: 'actions'}, this.calibrate),
        this.values, h('div', {class: 'actions'}, this.use));
  }

  protected update(): void {
    const {state, busy, measured} = this.now;
    if (!state) return;
    const light = tableOf(state.scene.light);
    const [azimuth, elevation] = SUN.map(([key, usual]) => numberOf(light[key]) ?? usual);
    this.showView();
    if (!this.isHeld) this.placeSun(azimuth, elevation);
    this.fields[0].show(azimuth);
    this.fields[1].show(elevation);
    const weather = tableOf(state.scene.weather);
    const realism = tableOf(state.scene.realism);
    const isMeasured = realism.auto === true || 'file' in realism;
    WEATHER.forEach(({key, on}, k) => {
      this.sliders[k].show(numberOf(weather[key]) ?? 1);
      this.sliders[k].input.disabled = on !== undefined && !isMeasured && !(key in weather) &&
          !Object.keys(tableOf(state.scene[on[0]])).some((name) => on[1].test(name));
    });
    const extinction = tableOf(state.scene.air).extinction_per_km;
    this.isHazeMeasured = isMeasured && extinction === undefined;
    this.haze.show(
        Array.isArray(extinction) && Number(extinction[1]) > 0 ? clamp(KOSCHMIEDER / Number(extinction[1]), 1, 199) :
                                                                 200);
    this.auto.input.checked = tableOf(state.scene.realism).auto === true;
    this.calibrate.disabled = busy !== null;
    this.use.hidden = !measured?.length;
    if (measured) this.showMeasured();
  }

  private slider(options: SliderOptions, change: (value: number) => [string[], Json]): Slider {
    let merge = '';
    const moved = (value: number, moved_ms: number, isBegin: boolean) => {
      if (isBegin) {
        merge = this.studio.merge('slider');
        this.studio.dragging(true);
      }
      const [path, to] = change(value);
      const isThere = path[1] in tableOf(this.now.state?.scene[path[0]]);
      if (to !== null || isThere) this.studio.edit([to === null ? {remove: path} : {set: path, to}], merge, moved_ms);
    };
    return new Slider(options, moved, () => this.studio.dragging(false));
  }

  private buildDome(): void {
    const ring = (r: number) => s('circle', {class: 'ring', r});
    const words = (x: number, y: number, word: string) => s('text', {x, y}, word);
    this.dome.append(
        s('circle', {class: 'sky', r: RADIUS}), this.view, ring(RADIUS / 3), ring((2 * RADIUS) / 3), words(0, -97, 'N'),
        words(103, 4, 'E'), words(0, 108, 'S'), words(-103, 4, 'W'), words(0, -RADIUS / 3 + 12, '60°'),
        words(0, (-2 * RADIUS) / 3 + 12, '30°'), this.sun);
    this.dome.addEventListener('pointerdown', (event) => {
      this.merge = this.studio.merge('sun');
      this.isHeld = true;
      this.dome.setPointerCapture(event.pointerId);
      this.studio.dragging(true);
      this.drag(event);
    });
    this.dome.addEventListener('pointermove', (event) => {
      if (this.isHeld) this.drag(event);
    });
    for (const end of ['pointerup', 'pointercancel'] as const)
      this.dome.addEventListener(end, () => {
        if (!this.isHeld) return;
        this.isHeld = false;
        this.studio.dragging(false);
      });
    this.dome.addEventListener('keydown', (event) => this.key(event));
  }

  private placeSun(azimuth_deg: number, elevation_deg: number): void {
    const r = clamp(((90 - elevation_deg) / 90) * RADIUS, 0, RADIUS + 12);
    attribute(this.sun, 'cx', round(r * Math.sin(radians(azimuth_deg)), 2));
    attribute(this.sun, 'cy', round(-r * Math.cos(radians(azimuth_deg)), 2));
    attribute(this.sun, 'class', elevation_deg < 0 ? 'sun set' : 'sun');
    const words = `azimuth ${round(turned(azimuth_deg), 0)} degrees, elevation ${round(elevation_deg, 0)} degrees`;
    attribute(this.dome, 'aria-valuetext', words);
    attribute(this.dome, 'aria-valuenow', round(elevation_deg, 0));
  }

  // Where the camera looks.
  private showView(): void {
    const {plan} = this.now;
    if (!plan) return;
    const half = Math.min(89, plan.horizontal_fov_deg / 2);
    const edge = (deg: number) =>
        `${round(RADIUS * Math.sin(radians(deg)), 1)},${round(-RADIUS * Math.cos(radians(deg)), 1)}`;
    const looks = plan.own.heading_deg;
    attribute(this.view, 'd', `M0,0L${edge(looks - half)}A${RADIUS},${RADIUS} 0 0 1 ${edge(looks + half)}Z`);
  }

  private drag(event: PointerEvent): void {
    const matrix = this.dome.getScreenCTM();
    if (!matrix) return;
    const {x, y} = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
    this.setSun(
        [round(turned(degrees(Math.atan2(x, -y))), 0), round(clamp(90 - (Math.hypot(x, y) / RADIUS) * 90, -10, 90), 0)],
        this.merge, event.timeStamp);
  }

  private key(event: KeyboardEvent): void {
    const by = arrow(event);
    if (!by) return;
    const light = tableOf(this.now.state?.scene.light);
    const [azimuth, elevation] = SUN.map(([key, usual]) => numberOf(light[key]) ?? usual);
    this.setSun([turned(azimuth + 5 * by[0]), clamp(elevation + 5 * by[1], -90, 90)], 'sun-keys', event.timeStamp);
  }

  private setSun([azimuth, elevation]: Point, merge: string, moved_ms: number): void {
    this.placeSun(azimuth, elevation);
    this.studio.edit(
        [{set: ['light', SUN[0][0]], to: azimuth}, {set: ['light', SUN[1][0]], to: elevation}], merge, moved_ms);
  }

  private auto_(isOn: boolean): void {
    if (isOn)
      this.studio.edit([{set: ['realism', 'auto'], to: true}, {set: ['realism', 'fallback'], to: true}]);
    else
      this.studio.edit(['auto', 'fallback']
                           .filter((key) => key in tableOf(this.now.state?.scene.realism))
                           .map((key) => ({remove: ['realism', key]})));
  }

  private showMeasured(): void {
    const measured = this.now.measured ?? [];
    const number = (value: Json): string =>
        (Array.isArray(value)          ? value.map(number).join(', ') :
             typeof value === 'number' ? String(Number(value.toPrecision(3))) :
             value === null            ? '' :
                                         String(value));
    const words = ({key, value, error, missing}: MeasuredValue) =>
        (value === null ? missing : `${number(value)}${error === null ? '' : ` ± ${number(error)}`} ${unitOf(key)}`);
    this.values.replaceChildren(...measured.map(
        (one) => h('tr', {}, h('th', {scope: 'row', title: one.key}, nameOf(one.key)), h('td', {}, words(one)))));
  }

  private useMeasured(): void {
    this.studio.edit((this.now.measured ?? [])
                         .filter(({value}) => value !== null)
                         .map(({key, value}) => ({set: key.split('.'), to: short(value)})));
  }
}
customElements.define('studio-light', LightPanel);
