// SPDX-License-Identifier: Apache-2.0
import {Connection, Lost, Refused} from './connection';
import type {AircraftGroup, Change, Clip, MeasuredValue, NearMiss, Path, Plan, Rendered, ServerEvent, State, Table, Told} from './contract';
import {type Edit, Edits, type Unsent} from './edits';
import {type Choice, type Flyer, type Moment, STATED, TO_MOMENTS, byEncounter, copyOf, flyerAt, flyersOf, momentsOf, newFlyer, tableOf, trackOf, withMoment} from './flyers';
import {type Point, clamp, seenNear} from './geometry';
import {Pictures} from './pictures';
import type {MadeNearMiss, Store} from './store';

const KEPT_LATENCIES = 500;
const KEPT_NEAR_MISSES = 100;
const REST_MS = 100;
const UNSENT_KEY = 'airtruth-studio-edits';

// An edit that is drawn before the next one is sent, and when the hand moved.
interface ShownEdit extends Edit {
  moved_ms?: number;
}

const keyOf = (encounter: Table) => JSON.stringify(Object.entries(encounter).sort());
const backgroundOf = (state: State) => JSON.stringify(state.scene.background ?? null);

// What a user can do, on the store and over the connection.
export class Studio {
  readonly latencies_ms: number[] = [];
  readonly pictures: Pictures;
  readonly edits: Edits;
  private merges = 0;
  private wholes = 0;  // undos, near misses and the like under way
  private rest: ReturnType<typeof setTimeout>|undefined;
  private planAsked = false;
  private planStale = false;
  private isDragged = false;
  private background = '';  // of the clip that is open

  constructor(readonly store: Store, readonly connection: Connection, private kept: Storage) {
    this.pictures = new Pictures(connection);
    this.edits = new Edits({
      send: (edit, upon) => this.send(edit, upon),
      upon: () => store.now.state?.sha256 ?? '',
      done: (state) => this.took(state),
      dropped: (count) => {
        store.say(
            'warning',
            `Not done, since the text of the scene is another one by now: ${count} ${
                count === 1 ? 'change' : 'changes'} made upon the text before.`);
        this.settle();
      },
      refused: (line) => {
        store.say('error', line);
        this.settle();
      },
      pending: (pending) => store.put({pending}),
    });
    this.pictures.onRefused = (line) => store.say('error', line);
    connection.onOpen = () => void this.opened();
    connection.onLost = () => this.lost();
    connection.onEvent = (event) => this.heard(event);
    store.listen((changed) => {
      if (['frame', 'showsAircraft', 'look', 'clip'].some((key) => changed.has(key as 'frame'))) this.refresh();
    });
  }

  // For a page that ends: what the server has not answered is kept for the next one.
  end(): void {
    const unsent = this.edits.unsent();
    if (unsent.edits.length)
      this.kept.setItem(UNSENT_KEY, JSON.stringify({file: this.store.now.file, unsent}));
    else
      this.kept.removeItem(UNSENT_KEY);
  }

  get isIdle(): boolean {
    return this.wholes === 0 && this.edits.isIdle && !this.planAsked && !this.planStale && this.pictures.isWhole &&
        this.rest === undefined;
  }

  // The selected flyer.
  get flyer(): Flyer|null {
    return flyerAt(this.store.now.state, this.store.now.selected);
  }

  // A moment of its path.
  moment(index: number): Moment|null {
    const {flyer} = this;
    const {clip} = this.store.now;
    return (flyer && clip && momentsOf(flyer, clip)[index]) ?? null;
  }

  // Chooses a moment of its path and goes to its frame; null where it has none.
  choose(index: number): Moment|null {
    const moment = this.moment(index);
    if (moment) {
      this.store.put({moment: index});
      this.show(moment.frame);
    }
    return moment;
  }

  // A name for edits that are one step of undo.
  merge(what: string): string {
    return `${what}-${++this.merges}-${Date.now()}`;
  }

  // An edit. Of a drag, which states when the hand moved, what it changes in the frame is drawn at once.
  edit(changes: Change[], merge: string|null = null, moved_ms?: number): void {
    const edit: ShownEdit = {changes, merge, moved_ms};
    this.edits.add(edit);
  }

  // While a pointer holds something, the whole frame waits.
  dragging(isDragged: boolean): void {
    this.isDragged = isDragged;
    if (!isDragged) this.settle();
  }

  readonly undo = () => this.whole('undo');
  readonly redo = () => this.whole('redo');
  async save(): Promise<void> {
    if (await this.whole('save')) this.store.say('info', `Saved ${this.store.now.file}`);
  }
  readonly reload = () => this.whole('reload');
  // Leaves another program's change of the file aside.
  readonly keep = () => this.whole('keep');

  select(selected: Path|null, moment: number|null = null): void {
    this.store.put({selected, moment});
    if (selected && this.store.now.tab === 'text') this.store.put({tab: 'flyers'});
  }

  show(frame: number): void {
    const {clip} = this.store.now;
    if (clip) this.store.put({frame: clamp(Math.round(frame), 0, clip.frames - 1)});
  }

  add(choice: Choice, at: Point|null = null): void {
    const {state, clip, plan, frame} = this.store.now;
    if (!state || !clip) return;
    if (clip.frames < 2) return this.store.say('error', 'A path by moments needs two frames; the clip has one.');
    const key = choice.kind === 'aircraft' ? 'intruder' : 'distractor';
    const list = state.scene[key];
    const count = Array.isArray(list) ? list.length : 0;
    const place = at ?? [clip.width * 0.3, clip.height * (0.3 + 0.08 * (flyersOf(state.scene).length % 5))];
    this.edit([{insert: [key], at: null, table: newFlyer(choice, state.scene, clip, frame, place as Point, plan)}]);
    this.store.put({selected: [key, count], moment: null, tab: 'flyers'});
  }

  duplicate(path: Path): void {
    const {state, clip} = this.store.now;
    const flyer = flyerAt(state, path);
    if (!flyer || !clip || !state) return;
    const count = (state.scene[String(path[0])] as unknown[]).length;
    this.edit([{insert: [path[0]], at: null, table: copyOf(flyer, clip)}]);
    this.store.put({selected: [path[0], count], moment: null});
  }

  remove(path: Path): void {
    this.edit([{remove: path}]);
    this.store.put({selected: null, moment: null});
  }

  // A moment of the selected path at the frame shown: at a pixel, or where the path is then.
  addMoment(at: Point|null = null): void {
    const {clip, plan, frame, selected} = this.store.now;
    const {flyer} = this;
    const track = trackOf(plan, selected);
    if (!clip || !this.hasMoments(flyer)) return;
    const seen = track && seenNear(track, frame);
    if (!seen) return this.store.say('info', 'The path is not known yet, or is never in the clip.');
    const {changes, index} = withMoment(flyer, clip, frame, at ?? seen.pixel, seen.range_m);
    this.edit(changes);
    this.store.put({moment: index});
  }

  removeMoment(): void {
    const {clip, moment} = this.store.now;
    const {flyer} = this;
    if (!clip || !this.hasMoments(flyer)) return;
    if (moment === null)
      return this.store.say('info', 'Choose a moment first. On the heading of a flyer, Delete deletes the flyer.');
    const moments = momentsOf(flyer, clip);
    if (moment >= moments.length) return;
    if (moments.length <= 2) {
      this.store.say(
          'info', 'A path has at least two moments. Delete the flyer with its button, or add a moment first.');
      return;
    }
    this.edit([{remove: moments[moment].path}]);
    this.store.put({moment: null});
  }

  // Whether a flyer is chosen and has moments; says what to do where not.
  private hasMoments(flyer: Flyer|null): flyer is Flyer {
    if (!flyer)
      this.store.say('info', 'Choose a flyer first: moments are those of its path.');
    else if (flyer.statement === 'lens')
      this.store.say('info', 'What is on the lens has no path.');
    else if (flyer.statement !== 'moments')
      this.store.say(
          'info', `The path of ${flyer.id} is stated ${STATED[flyer.statement]}. “${TO_MOMENTS}” gives it moments.`);
    return flyer?.statement === 'moments';
  }

  // To the next or the last moment of the selected path.
  goToMoment(step: 1|- 1): void {
    const {clip, frame} = this.store.now;
    const {flyer} = this;
    if (!clip || !this.hasMoments(flyer)) return;
    const moments = momentsOf(flyer, clip);
    const next = step > 0 ? moments.findIndex((one) => one.frame > frame) :
                            moments.length - 1 - [...moments].reverse().findIndex((one) => one.frame < frame);
    if (next < 0 || next >= moments.length) return;
    this.choose(next);
  }

  // Lets the selected path go on straight from the frame shown, past the own aircraft.
  async nearMiss(asked: NearMiss, frame = this.store.now.frame): Promise<void> {
    const {flyer} = this;
    if (!flyer || !this.isConnected()) return;
    const {above_m, ...wanted} = asked;
    this.wholes += 1;
    try {
      await this.edits.whenIdle();
      const {encounter} = await this.connection.request<{encounter: Table}>(
          'near_miss', {intruder: flyer.path[1], frame, ...wanted, ...(above_m === null ? {} : {above_m})});
      const now = flyerAt(this.store.now.state, flyer.path);
      if (!now) return;
      const others = Object.entries(this.store.now.nearMisses).slice(1 - KEPT_NEAR_MISSES);
      this.store.put({nearMisses: Object.fromEntries([...others, [keyOf(encounter), {asked, frame}]])});
      this.edit(byEncounter(now, encounter));
    } catch (error) {
      this.failed(error);
    } finally {
      this.wholes -= 1;
    }
  }

  // The near miss that the selected path still is; null where it is none, or was edited otherwise.
  get madeBy(): MadeNearMiss|null {
    const {encounter} = this.flyer?.table ?? {};
    return encounter ? this.store.now.nearMisses[keyOf(tableOf(encounter))] ?? null : null;
  }

  async search(text: string): Promise<AircraftGroup[]> {
    const {groups} = await this.connection.request<{groups: AircraftGroup[]}>('aircraft', {search: text});
    return groups;
  }

  calibrate(): Promise<void> {
    return this.long('calibrate', async () => {
      const {values} = await this.connection.request<{values: MeasuredValue[]}>('calibrate');
      this.store.put({measured: values});
    });
  }

  render(): Promise<void> {
    return this.long('render', async () => {
      if (!this.store.now.state?.saved && !(await this.whole('save'))) return;
      this.store.put({film: await this.connection.request<Rendered>('render')});
    });
  }

  async cancel(): Promise<void> {
    await this.connection.request('cancel').catch((error) => this.failed(error));
  }

  // The whole frame that is to be seen now.
  refresh(): void {
    const {clip, state, frame, showsAircraft, look, playing} = this.store.now;
    if (!clip || !state || !this.store.now.connected) return;
    const shownScale = (look?.scale ?? 0.5) * window.devicePixelRatio;
    const scale = clip.width > 1920 && shownScale <= 0.5 && (playing || !this.edits.isIdle) ? 0.5 : 1;
    this.pictures.want({frame, revision: state.revision, aircraft: showsAircraft && !state.problem, scale});
  }

  private async send(edit: ShownEdit, upon: string): Promise<State|null> {
    const answer =
        this.connection.request<{state: Told; done: boolean}>('edit', {changes: edit.changes, merge: edit.merge, upon});
    const {moved_ms} = edit;
    const {frame, showsAircraft} = this.store.now;
    const isShown = moved_ms !== undefined && showsAircraft;
    const change = isShown ? this.pictures.change(frame).catch(() => null) : null;
    const {done, ...answered} = await answer;
    const state = this.known(answered.state);
    if (!done) {
      this.took(state);
      return null;
    }
    if (change && state.revision > (this.store.now.state?.revision ?? -1)) this.store.put({state});
    const drawn = await change;
    if (isShown && typeof drawn === 'number' && drawn >= state.revision) this.measured(performance.now() - moved_ms);
    return state;
  }

  // Of a text that is no TOML the scene is that of the text before, and the text is what is to be seen.
  private known({scene, ...state}: Told): State {
    if (!scene) this.store.put({tab: 'text'});
    return {...state, scene: scene ?? this.store.now.state?.scene ?? {}};
  }

  private measured(latency_ms: number): void {
    this.latencies_ms.push(latency_ms);
    if (this.latencies_ms.length > KEPT_LATENCIES) this.latencies_ms.shift();
  }

  private took(answered: State): void {
    const {selected, notices, state: known} = this.store.now;
    // Another page's edit may have been heard of in the meantime.
    const state = known && known.revision > answered.revision ? known : answered;
    // What was refused before is past.
    const rest = notices.filter((notice) => notice.kind !== 'error');
    if (rest.length < notices.length) this.store.put({notices: rest});
    this.store.put(
        {state, ...(selected && !flyerAt(state, selected) && this.edits.isIdle ? {selected: null, moment: null} : {})});
    this.openIfOther(state);
    this.settle();
  }

  // The clip of a scene that has another one now, or that can be used at last.
  private openIfOther(state: State): void {
    if (state.problem || backgroundOf(state) === this.background) return;
    this.background = backgroundOf(state);
    void this.opened();
  }

  // After an edit: the paths, and the whole frame where its part was not enough, when the hand rests; both take longer
  // than a picture of a drag may.
  private settle(): void {
    clearTimeout(this.rest);
    const isSoon = this.edits.isIdle && !this.isDragged;
    this.rest = setTimeout(() => {
      this.rest = undefined;
      if (!this.edits.isIdle) return;
      this.refresh();
      void this.plan();
    }, isSoon ? 0 : REST_MS);
  }

  private async plan(): Promise<void> {
    this.planStale = true;
    if (this.planAsked) return;
    this.planAsked = true;
    try {
      while (this.planStale) {
        this.planStale = false;
        const plan = await this.connection.request<Plan>('plan');
        const isDone = !this.isDragged && this.edits.isIdle && !this.planStale;
        this.store.put({plan, planProblem: null, ...(isDone ? {draft: null} : {})});
      }
    } catch (error) {
      this.planStale = false;
      if (error instanceof Refused) this.store.put({planProblem: error.message});
    } finally {
      this.planAsked = false;
    }
  }

  // What is done to the whole text, after all edits; whether it was.
  private async whole(what: 'undo'|'redo'|'save'|'reload'|'keep'): Promise<boolean> {
    if (!this.isConnected()) return false;
    this.wholes += 1;
    try {
      await this.edits.whenIdle();
      const {state: before} = this.store.now;
      if ((what === 'undo' && !before?.undo) || (what === 'redo' && !before?.redo)) return false;
      const {state} = await this.connection.request<{state: Told}>(what);
      this.took(this.known(state));
      return true;
    } catch (error) {
      this.failed(error);
      return false;
    } finally {
      this.wholes -= 1;
    }
  }

  private async long(what: 'render'|'calibrate', work: () => Promise<void>): Promise<void> {
    if (this.store.now.busy || !this.isConnected()) return;
    await this.edits.whenIdle();
    this.store.put({busy: what, progress: {of: what, done: 0, total: 0}});
    try {
      await work();
    } catch (error) {
      this.failed(error);
    } finally {
      this.store.put({busy: null, progress: null});
    }
  }

  // Says where it is not: what is asked for without a connection is not done later.
  private isConnected(): boolean {
    const {connected} = this.store.now;
    if (!connected) this.store.say('info', 'Not done: there is no connection to airtruth studio.');
    return connected;
  }

  private failed(error: unknown): void {
    if (error instanceof Refused)
      this.store.say('error', error.message);
    else if (!(error instanceof Lost))
      throw error;
  }

  private async opened(): Promise<void> {
    try {
      const {file, clip, out, ...answer} =
          await this.connection.request<{file: string; clip: Clip | null; out: string; state: Told}>('open');
      const state = this.known(answer.state);
      if (clip) this.pictures.begin(clip);
      this.background = clip ? backgroundOf(state) : '';
      this.pictures.forget();
      this.store.put({
        connected: true,
        everConnected: true,
        file,
        clip,
        out,
        state,
        frame: clamp(this.store.now.frame, 0, (clip?.frames ?? 1) - 1)
      });
      if (this.store.now.selected && !flyerAt(state, this.store.now.selected))
        this.store.put({selected: null, moment: null});
      this.edits.resume();
      this.takeUnsent(file);
      this.settle();
    } catch (error) {
      this.failed(error);
    }
  }

  private takeUnsent(file: string): void {
    const kept = JSON.parse(this.kept.getItem(UNSENT_KEY) ?? 'null') as {
      file: string;
      unsent: Unsent
    }
    |null;
    this.kept.removeItem(UNSENT_KEY);
    if (kept?.file === file) this.edits.restore(kept.unsent);
  }

  private lost(): void {
    this.edits.stop();
    this.pictures.forget();
    this.store.put({connected: false, playing: false, refused: !this.store.now.everConnected});
  }

  private heard(event: ServerEvent): void {
    if (event.event === 'progress') {
      this.store.put({progress: event});
    } else if (event.event === 'measured') {
      this.store.put({progress: this.store.now.busy ? this.store.now.progress : null});
      this.pictures.forget();
      this.settle();
    } else if (event.event === 'warning') {
      this.store.say('warning', event.line);
    } else if (event.state.revision >= (this.store.now.state?.revision ?? 0) || this.edits.isIdle) {
      const state = this.known(event.state);
      // Where another page or program has added or removed flyers, a place in the file is that of another one.
      const {state: before} = this.store.now;
      const names = (scene: Table) => JSON.stringify(flyersOf(scene).map(({path, table}) => [path[0], table.id]));
      const isOther =
          before && this.wholes === 0 && this.edits.isIdle && names(state.scene) !== names(before.scene);
      const isNew = state.revision !== this.store.now.state?.revision || state.text !== this.store.now.state?.text;
      this.store.put({state, ...(isOther ? {selected: null, moment: null} : {})});
      this.openIfOther(state);
      if (isNew) this.settle();
    }
  }
}
