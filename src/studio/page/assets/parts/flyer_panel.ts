// SPDX-License-Identifier: Apache-2.0
import type {Change, Clip, Json, NearMiss, Table} from '../model/contract';
import {type Flyer, type Moment, STATED, TO_MOMENTS, MOST_MISS_M, SPEEDS_MPS, describedApproach, frameOf, missOf, momentsOf, numberOf, roomOf, tableOf, timeOf, toApproach, toMoments, trackOf, withCourse, withMiss, writtenRange, writtenWidth} from '../model/flyers';
import {round, speedOf, velocityAt} from '../model/geometry';
import type {Member} from '../model/store';
import type {Studio} from '../model/studio';
import {NumberField, type NumberOptions, choiceField} from './fields';
import {NearMissForm} from './near_miss_form';
import {Part, attribute, button, h, text, token} from './part';

interface KeyOptions extends NumberOptions {
  key: string[];
  default: number|null;
  limits?: (encounter: Table) => [number, number];  // that follow from other numbers
}

// Of a scene's numbers (src/scene/scene/limits.h).
const MOST_PX = 1e5;
const [LEAST_MPS, MOST_MPS] = SPEEDS_MPS;
const SIZES: Record<string, [number, number, string]> = {
  range_m: [0.1, 1e6, 'm'],
  width_px: [0.1, 1e5, 'px']
};
const MISS = {
  step: 1,
  min: -MOST_MISS_M,
  max: MOST_MISS_M
};
const climbOf = (encounter: Table) => Math.abs(numberOf(encounter.climb_mps) ?? 0);

const ENCOUNTER: KeyOptions[] = [
  {key: ['encounter', 'cpa_time_s'], label: 'Closest at', unit: 's', step: 0.1, default: null},
  {key: ['encounter', 'cpa_right_m'], label: 'Right', unit: 'm', ...MISS, default: 0, placeholder: 'follows'},
  {key: ['encounter', 'cpa_above_m'], label: 'Above', unit: 'm', ...MISS, default: 0},
  {key: ['encounter', 'cpa_ahead_m'], label: 'Ahead', unit: 'm', ...MISS, default: null, placeholder: 'follows'},
  {key: ['encounter', 'course_deg'], label: 'Course', unit: '°', step: 1, min: -360, max: 360, default: 180},
  {
    key: ['encounter', 'speed_mps'],
    label: 'Speed',
    unit: 'm/s',
    step: 1,
    default: null,
    limits: (encounter) => [Math.max(LEAST_MPS, climbOf(encounter)), MOST_MPS]
  },
  {
    key: ['encounter', 'climb_mps'],
    label: 'Climb',
    unit: 'm/s',
    step: 0.5,
    default: 0,
    limits: ({speed_mps}) => [-(numberOf(speed_mps) ?? MOST_MPS), numberOf(speed_mps) ?? MOST_MPS]
  },
  {key: ['encounter', 'turn_rate_dps'], label: 'Turn rate', unit: '°/s', step: 0.5, min: -90, max: 90, default: 0},
];
const FLOCK: KeyOptions[] = [
  {key: ['size_m'], label: 'Size', unit: 'm', step: 0.05, min: 0.05, max: 20, default: null, placeholder: 'usual'},
  {key: ['count'], label: 'Birds', unit: '', step: 1, min: 1, max: 200, default: 1},
  {key: ['spread_m'], label: 'Flock radius', unit: 'm', step: 1, min: 0, max: 10000, default: null},
];

// The numbers of the selected flyer: its path in the words that it is stated in, and what flies.
export class FlyerPanel extends Part {
  protected readonly watches: Member[] = ['state', 'plan', 'selected', 'moment', 'clip', 'frame'];
  private built = '';
  private fields: {options: KeyOptions; field: NumberField}[] = [];
  private rows: MomentRow[] = [];
  private nearMiss = new NearMissForm(this.studio);
  private miss = new NumberField({label: 'Miss distance', unit: 'm', step: 1, min: 0, max: MOST_MISS_M}, (value) => {
    const {flyer} = this.studio;
    const {plan, clip} = this.now;
    if (flyer && plan && clip && !this.passesAgain({miss_m: value}))
      this.studio.edit(withMiss(flyer, plan, clip, value));
  });
  private keeps = h('p', {class: 'hint'});
  private portrait = h('img', {alt: '', width: 56, height: 56});
  private seenAs = h('p', {class: 'hint'});

  protected build(): void {}

  protected update(): void {
    const {flyer} = this.studio;
    const {clip, plan} = this.now;
    if (!flyer || !clip) return;
    const moments = momentsOf(flyer, clip);
    const shape =
        JSON.stringify([flyer.path, flyer.kind, flyer.statement, moments.map((one) => one.width_px !== null)]);
    if (shape !== this.built) this.shape(flyer, moments);
    this.built = shape;
    for (const {options, field} of this.fields) {
      field.show(valueAt(flyer.table, options.key) ?? defaultOf(options, flyer));
      if (options.limits) field.limit(...options.limits(tableOf(flyer.table.encounter)));
    }
    moments.forEach((moment, k) => this.rows[k].show(moment, this.now.moment === k, roomOf(moments, k, clip), clip));
    const track = trackOf(plan, flyer.path);
    const velocity = plan && track && velocityAt(plan, track.ned, this.now.frame, clip);
    this.nearMiss.show(flyer, timeOf(this.now.frame, clip), velocity && speedOf(velocity));
    if (plan && flyer.statement === 'approach') {
      const {miss_m, least_m} = missOf(flyer, plan, clip);
      this.miss.limit(round(least_m, 1), MOST_MISS_M, 'm', 'since it is so far above or below');
      this.miss.show(round(miss_m, 1));
      const made = this.studio.madeBy;
      text(
          this.keeps,
          made ? `Its pixel at ${timeOf(made.frame, clip)} s stays under Miss distance, Above and Speed alone.` : '');
    }
    const approach = track ? track.approach || (track.cpa ? describedApproach(track.cpa) : '') : '';
    // What the checks say already is not said twice.
    text(this.seenAs, track?.checks.includes(approach) ? '' : approach);
    const title = this.querySelector('.what .title');
    if (title) text(title, flyer.title);
    const name = flyer.kind === 'aircraft' ? flyer.title : flyer.kind;
    // What cannot be loaded, a model file and what is on the lens have no picture.
    this.portrait.hidden = !track || flyer.statement === 'lens' || /\.\w+$/.test(name);
    if (!this.portrait.hidden)
      attribute(this.portrait, 'src', `/aircraft.jpg?token=${token}&name=${encodeURIComponent(name)}`);
  }

  private shape(flyer: Flyer, moments: Moment[]): void {
    this.fields = [];
    this.rows = moments.map((_, k) => new MomentRow(this.studio, k));
    const path = flyer.path;
    const isNatural = flyer.kind === 'bird' || flyer.kind === 'multirotor' || flyer.kind === 'balloon';
    const keys = isNatural ? FLOCK.filter(({key}) => flyer.kind === 'bird' || key[0] === 'size_m') : [];
    this.replaceChildren(
        h('div', {class: 'what'}, this.portrait, h('span', {class: 'title'}),
          flyer.kind === 'aircraft' &&
              button('Change …', () => this.studio.store.put({dialog: 'gallery', replaces: path}))),
        ...(keys.length ? [h('div', {class: 'grid'}, ...keys.map((one) => this.keyField(one)))] : []),
        h('h3', {}, STATED[flyer.statement].replace(/^./, (first) => first.toUpperCase())), ...this.statement(flyer),
        ...(flyer.kind === 'aircraft' ? [this.nearMiss.element] : []),
        h('div', {class: 'actions'}, button('Duplicate', () => this.studio.duplicate(path)),
          button('Delete', () => this.studio.remove(path), {class: 'danger', title: 'Delete on the heading'})),
        this.seenAs);
  }

  private statement(flyer: Flyer): Node[] {
    if (flyer.statement === 'moments') {
      return [
        h('div', {class: 'moments', role: 'table', 'aria-label': 'Moments'}, MomentRow.head(),
          ...this.rows.map((row) => row.element)),
        h('div', {class: 'actions'},
          button('Add a moment here', () => this.studio.addMoment(), {title: 'At the frame shown (M)'}),
          flyer.kind === 'aircraft' && button('State by closest approach', () => this.restate(toApproach))),
      ];
    }
    const turn = flyer.statement === 'lens' ?
        [] :
        [h('div', {class: 'actions'}, button(TO_MOMENTS, () => this.restate(toMoments)))];
    if (flyer.statement !== 'approach') return turn;
    return [
      h('div', {class: 'grid'}, this.miss.element, ...ENCOUNTER.map((one) => this.keyField(one))), this.keeps, ...turn
    ];
  }

  private keyField(options: KeyOptions): HTMLElement {
    const field = new NumberField(options, (value) => this.take(options, value));
    this.fields.push({options, field});
    return field.element;
  }

  private take(options: KeyOptions, value: number): void {
    const {flyer} = this.studio;
    if (!flyer) return;
    const to = options.key[0] === 'count' ? Math.round(value) : value;
    const {plan, clip} = this.now;
    if (options.key[1] === 'cpa_above_m' && this.passesAgain({above_m: to})) return;
    if (options.key[1] === 'speed_mps' && this.passesAgain({speed_mps: to})) return;
    if (options.key[1] === 'course_deg' && plan && clip) return this.studio.edit(withCourse(flyer, plan, clip, to));
    const changes: Change[] = [{set: [...flyer.path, ...options.key], to}];
    if (options.key[0] === 'count' && to > 1 && !('spread_m' in flyer.table))
      changes.push({set: [...flyer.path, 'spread_m'], to: 8});
    if (options.key[0] === 'count' && to === 1 && 'spread_m' in flyer.table)
      changes.push({remove: [...flyer.path, 'spread_m']});
    // One of right and ahead follows from the other.
    const other = {cpa_right_m: 'cpa_ahead_m', cpa_ahead_m: 'cpa_right_m'}[options.key[1]];
    if (other && other in tableOf(flyer.table.encounter))
      changes.unshift({remove: [...flyer.path, 'encounter', other]});
    this.studio.edit(changes);
  }

  // Whether the path is a near miss, which then passes otherwise, still through its pixel.
  private passesAgain(part: Partial<NearMiss>): boolean {
    const made = this.studio.madeBy;
    if (made) void this.studio.nearMiss({...made.asked, ...part}, made.frame);
    return made !== null;
  }

  private restate(how: typeof toApproach|typeof toMoments): void {
    const {flyer} = this.studio;
    const {clip, plan} = this.now;
    const track = flyer && trackOf(plan, flyer.path);
    const changes = flyer && track && clip && plan ?
        (how === toMoments ? toMoments(flyer, track, clip) : toApproach(flyer, track, plan, clip)) :
        null;
    if (changes)
      this.studio.edit(changes);
    else
      this.studio.store.say('info', 'This path cannot be stated so: it is not in the clip.');
  }
}
customElements.define('studio-flyer', FlyerPanel);

// Where what is ahead is stated, what is right of it follows.
const defaultOf = (options: KeyOptions, flyer: Flyer) =>
    options.key[1] === 'cpa_right_m' && 'cpa_ahead_m' in tableOf(flyer.table.encounter) ? null : options.default;

const valueAt = (table: Json, key: string[]): number|null =>
    numberOf(key.reduce<Json|undefined>((at, name) => tableOf(at)[name], table));

// A moment's numbers in one line of the table.
class MomentRow {
  readonly element: HTMLElement;
  private time: NumberField;
  private x: NumberField;
  private y: NumberField;
  private size: NumberField;
  private unit = choiceField(
      'Size of the moment in', [['range_m', 'm'], ['width_px', 'px']],
      (key) => this.sizeIn(key as 'range_m' | 'width_px'));

  static head(): HTMLElement {
    return h(
        'div', {class: 'row head', role: 'row'},
        ...['time, s', 'x, px', 'y, px', 'range or width', ''].map((name) => h('span', {role: 'columnheader'}, name)));
  }

  constructor(private studio: Studio, private index: number) {
    const field = (label: string, unit: string, step: number, taken: (value: number) => void) =>
        new NumberField({label: `${label} of moment ${index + 1}`, unit, step, isLabelHidden: true}, taken);
    this.time = field('Time', 's', 0.1, (value) => this.setTime(value));
    this.x = field('X', 'px', 0.1, (value) => this.setPixel(0, value));
    this.y = field('Y', 'px', 0.1, (value) => this.setPixel(1, value));
    this.size = field('Size', '', 0.1, (value) => this.set(this.unit.select.value, value));
    for (const one of [this.x, this.y]) one.limit(-MOST_PX, MOST_PX);
    for (const {element} of [this.time, this.x, this.y]) element.querySelector('.unit')?.remove();
    const pressed = () => {
      this.studio.store.put({moment: index});
      this.studio.removeMoment();
    };
    const remove = button(
        '×', pressed,
        {class: 'small', 'aria-label': `Remove moment ${index + 1}`, title: 'Remove this moment (Delete)'});
    const size = h('span', {class: 'size'}, this.size.element, this.unit.select);
    this.element =
        h('div', {class: 'row', role: 'row', onfocusin: ((event: FocusEvent) => this.entered(event)) as EventListener},
          ...[this.time.element, this.x.element, this.y.element, size, remove].map(
              (one) => h('span', {role: 'cell'}, one)));
  }

  show(moment: Moment, isChosen: boolean, [first, last]: [number, number], clip: Clip): void {
    attribute(this.element, 'class', isChosen ? 'row chosen' : 'row');
    this.time.limit(timeOf(first, clip), timeOf(last, clip), 's', 'between the moments beside it');
    this.time.show(moment.time_s);
    this.x.show(moment.pixel[0]);
    this.y.show(moment.pixel[1]);
    this.unit.select.value = moment.width_px !== null ? 'width_px' : 'range_m';
    this.size.limit(...SIZES[this.unit.select.value]);
    this.size.show(moment.width_px ?? moment.range_m);
  }

  // That of the nearest frame, to which the picture goes with it.
  private setTime(time_s: number): void {
    const {clip} = this.studio.store.now;
    if (!clip) return;
    const frame = frameOf(time_s, clip);
    this.set('time_s', timeOf(frame, clip));
    this.studio.show(frame);
  }

  // In the other words.
  private sizeIn(key: 'range_m'|'width_px'): void {
    const {flyer} = this.studio;
    const moment = this.studio.moment(this.index);
    const known = flyer && trackOf(this.studio.store.now.plan, flyer.path)?.handles[this.index]?.[key];
    if (!moment || !known) return;
    const other = key === 'range_m' ? 'width_px' : 'range_m';
    this.studio.edit([
      {remove: [...moment.path, other]},
      {set: [...moment.path, key], to: key === 'range_m' ? writtenRange(known) : writtenWidth(known)}
    ]);
  }

  // From outside the row; within it a time that was just entered is the one to be shown.
  private entered(event: FocusEvent): void {
    if (!this.element.contains(event.relatedTarget as Node | null)) this.studio.choose(this.index);
  }

  private set(key: string, to: Json): void {
    const moment = this.studio.moment(this.index);
    if (moment) this.studio.edit([{set: [...moment.path, key], to}]);
  }

  private setPixel(axis: 0|1, value: number): void {
    const moment = this.studio.moment(this.index);
    if (moment) this.set('pixel', axis === 0 ? [value, moment.pixel[1]] : [moment.pixel[0], value]);
  }
}
