// SPDX-License-Identifier: Apache-2.0
// The page's state without its elements. tests/studio_test.py bundles and runs it in a browser.
import {Lost, Refused} from './connection';
import type {Clip, Plan, State, Table, Track} from './contract';
import {type Edit, Edits} from './edits';
import {type Flyer, copyOf, describedView, flyersOf, missOf, momentsOf, nearer, newFlyer, roomOf, timeOf, toApproach, toMoments, withCourse, withMiss, withMoment} from './flyers';
import {frameAt, freePlace, nedAt, seenAt, timeAt, turned} from './geometry';
import {Store} from './store';

type Test = () => void|Promise<void>;
const tests: Record<string, Test> = {};
const turn = () => new Promise<void>((done) => setTimeout(done, 0));

function same(got: unknown, wanted: unknown): void {
  if (JSON.stringify(got) !== JSON.stringify(wanted))
    throw new Error(`${JSON.stringify(got)}; expected ${JSON.stringify(wanted)}`);
}
function near(got: number, wanted: number, tolerance: number): void {
  if (!(Math.abs(got - wanted) <= tolerance)) throw new Error(`${got}; expected ${wanted} within ${tolerance}`);
}

const CLIP: Clip = {
  video: 'flight.mp4',
  width: 1280,
  height: 960,
  frames: 150,
  rate_hz: 30,
  begin_s: 0,
  times_s: [],
  first_frame: 0,
};
const flyer = (table: Table, key = 'intruder'): Flyer => flyersOf({[key]: [table]})[0];
const track = (pixel: (frame: number) => [number, number], frames = 150): Track => ({
  table: ['intruder', 0],
  id: 'a',
  handles: [],
  cpa: null,
  checks: [],
  approach: '',
  ned: [],
  points: Array.from({length: frames}, (_, k) => [k, ...pixel(k), 500, 40, true]),
});

// A server that answers when it is told to.
class Server {
  sha256 = 'text 0';
  sent: Edit[] = [];
  upon: string[] = [];  // of those that were sent
  dropped = 0;
  states: number[] = [];
  refusals: string[] = [];
  pending = 0;
  private answers: {resolve: (state: State|null) => void; reject: (error: Error) => void}[] = [];
  edits = new Edits({
    send: (edit, upon) => {
      this.sent.push(edit);
      this.upon.push(upon);
      return new Promise((resolve, reject) => this.answers.push({resolve, reject}));
    },
    upon: () => this.sha256,
    done:
        (state) => {
          this.sha256 = state.sha256;
          this.states.push(state.revision);
        },
    dropped:
        (count) => {
          this.dropped += count;
        },
    refused: (line) => this.refusals.push(line),
    pending:
        (count) => {
          this.pending = count;
        },
  });

  async answer(): Promise<void> {
    const revision = this.states.length + 1;
    this.answers.shift()!.resolve({revision, sha256: `text ${revision}`} as State);
    await turn();
  }
  async drop(): Promise<void> {
    this.answers.shift()!.resolve(null);
    await turn();
  }
  async fail(error: Error): Promise<void> {
    this.answers.shift()!.reject(error);
    await turn();
  }
  set(to: number, merge: string|null = null): void {
    this.edits.add({changes: [{set: ['seed'], to}], merge});
  }
  insert(): void {
    this.edits.add({changes: [{insert: ['intruder'], at: null, table: {}}], merge: null});
  }
  values(): unknown[] {
    return this.sent.map((edit) => ('to' in edit.changes[0] ? edit.changes[0].to : 'insert'));
  }
}

tests['Of a drag that waits only the newest is sent'] = async () => {
  const server = new Server();
  server.edits.resume();
  for (let k = 1; k <= 5; ++k) server.set(k, 'drag');
  same(server.values(), [1]);
  await server.answer();
  same(server.values(), [1, 5]);
  await server.answer();
  same([server.edits.isIdle, server.pending], [true, 0]);
};
tests['Edits of two drags, and of none, stay apart and in order'] = async () => {
  const server = new Server();
  server.edits.resume();
  server.set(1, 'a');
  server.set(2, 'a');
  server.set(3, 'b');
  server.set(4);
  server.set(5);
  for (let k = 0; k < 5; ++k) await server.answer();
  same(server.values(), [1, 2, 3, 4, 5]);
};
tests['An edit that is refused is said, and the next goes on'] = async () => {
  const server = new Server();
  server.edits.resume();
  server.set(1);
  server.set(2);
  await server.fail(new Refused('no'));
  same([server.refusals, server.values()], [['no'], [1, 2]]);
};
tests['After a lost connection what was not answered is sent again'] = async () => {
  const server = new Server();
  server.edits.resume();
  server.set(1);
  server.set(2);
  server.edits.stop();
  await server.fail(new Lost('gone'));
  same([server.values(), server.edits.isIdle], [[1], false]);
  server.edits.resume();
  await server.answer();
  await server.answer();
  same(server.values(), [1, 1, 2]);
};
tests['Each edit is sent with the text that it was made upon, also after a lost connection'] = async () => {
  const server = new Server();
  server.edits.resume();
  server.insert();
  server.set(1);
  server.edits.stop();
  await server.fail(new Lost('gone'));
  server.sha256 = 'text of another program';
  server.edits.resume();
  await server.answer();
  await server.answer();
  same(server.upon, ['text 0', 'text 0', 'text 1']);
};
tests['Edits of a text that is another one by now are dropped, and counted'] = async () => {
  const server = new Server();
  server.edits.resume();
  for (let k = 1; k <= 3; ++k) server.set(k);
  await server.answer();
  server.sha256 = 'text of another program';
  await server.drop();
  same([server.values(), server.dropped, server.edits.isIdle, server.pending], [[1, 2], 2, true, 0]);
  server.set(4);
  same(server.upon, ['text 0', 'text 1', 'text of another program']);
};
tests['What a page left behind is taken up by the next'] = async () => {
  const first = new Server();
  first.edits.resume();
  first.set(1);
  first.insert();
  first.set(2);
  const left = JSON.parse(JSON.stringify(first.edits.unsent()));
  const next = new Server();
  next.sha256 = 'text of another program';
  next.edits.resume();
  next.edits.restore(left);
  for (let k = 0; k < 3; ++k) await next.answer();
  same([next.values(), next.upon[0]], [[1, 'insert', 2], 'text 0']);
};
tests['Listeners are told once of all that changed'] = async () => {
  const store = new Store();
  const told: string[][] = [];
  store.listen((changed) => told.push([...changed].sort()));
  store.put({frame: 3});
  store.put({frame: 4, playing: true});
  store.put({frame: 4});
  await turn();
  same(told, [['frame', 'playing']]);
};
tests['The miss distance of an encounter, and another one on its side'] = () => {
  // At right angles from the left, 40 over 20 m/s: 30 m to the left is 60 m behind, as (1, 2) lies across.
  const one = flyer({encounter: {cpa_time_s: 2, cpa_right_m: -30, course_deg: 90, speed_mps: 40}});
  const ned = Array.from({length: 151}, (_, k) => [(20 * k) / 30, 0, -100]);
  const plan = {frames: ned.map((_, k) => k), own: {ned}} as never;
  near(missOf(one, plan, CLIP).miss_m, Math.hypot(30, 60), 1e-6);
  same(withMiss(one, plan, CLIP, 100), [{set: ['intruder', 0, 'encounter', 'cpa_right_m'], to: -44.7}]);
  same(withCourse(one, plan, CLIP, 180)[1], {set: ['intruder', 0, 'encounter', 'cpa_right_m'], to: -67.1});
  // Head-on at 60 m/s, 30 m above and climbing at 10 m/s it is nearest 30 * 10 / 60 m before it is abeam.
  const climbs = flyer({
    encounter:
        {cpa_time_s: 2, cpa_right_m: 40, cpa_above_m: 30, course_deg: 180, speed_mps: Math.hypot(40, 10), climb_mps: 10}
  });
  near(missOf(climbs, plan, CLIP).miss_m, Math.hypot(40, 30, 5), 1e-6);
  near(missOf(climbs, plan, CLIP).least_m, Math.hypot(30, 5), 1e-6);
  same(
      withMiss(climbs, plan, CLIP, Math.hypot(20, 30, 5)),
      [{set: ['intruder', 0, 'encounter', 'cpa_right_m'], to: 20}]);
  const across = flyer({encounter: {cpa_time_s: 2, cpa_ahead_m: 0, course_deg: 180, speed_mps: 40}});
  same(missOf(across, plan, CLIP), {miss_m: 0, least_m: 0});
  same(
      withMiss(across, plan, CLIP, 50).map((one) => 'remove' in one || one),
      [true, {set: ['intruder', 0, 'encounter', 'cpa_right_m'], to: 50}]);
};
tests['Between the points of a track, and beyond its ends'] = () => {
  const one = track((k) => [10 * k, 100], 11);
  near(seenAt(one, 4.5)!.pixel[0], 45, 1e-9);
  same(seenAt(one, 11), null);
  const plan = {frames: [0, 10], own: {ned: []}} as never;
  same(nedAt(plan, [[0, 0, -100], [10, 20, -110]], 15), [15, 30, -115]);
  same(turned(-90), 270);
};
tests['Frames of a variable rate have their own times'] = () => {
  // Ten frames at 30 Hz, then ten at 10 Hz.
  const clip: Clip = {
    ...CLIP,
    frames: 20,
    rate_hz: 15,
    times_s: Array.from({length: 20}, (_, k) => (k < 10 ? k : 10 + 3 * (k - 10)) / 30)
  };
  same([5, 10, 12, 19].map((frame) => timeOf(frame, clip)), [0.167, 0.333, 0.533, 1.233]);
  for (let frame = -5; frame < 30; frame += 0.5) near(frameAt(timeAt(frame, clip), clip), frame, 1e-9);
  same(
      momentsOf(flyer({seen: [0.167, 0.533].map((time_s) => ({time_s, pixel: [1, 1], range_m: 9}))}), clip)
          .map((one) => one.frame),
      [5, 12]);
};
tests['What is new is in the clip, and at its pixel in the frame shown'] = () => {
  for (const frame of [0, 60, 149]) {
    const table = newFlyer(
        {kind: 'aircraft', aircraft: '738/738-ANA', length_m: 39.5}, {lens: {vertical_fov_deg: 60}}, CLIP, frame,
        [300, 200], null);
    same(Object.keys(table), ['aircraft', 'seen']);
    const moments = momentsOf(flyer(table), CLIP);
    same(
        [
          moments.length, moments.every((one) => one.frame >= 0 && one.frame < 150), moments[1].frame > moments[0].frame
        ],
        [2, true, true]);
    same(moments.find((one) => one.frame === frame)?.pixel, [300, 200]);
  }
};
tests['What is new flies level'] = () => {
  // The own aircraft sinks by 2 m/s and pitches, so that the horizon moves.
  const frames = Array.from({length: 31}, (_, k) => 5 * k);
  const ned = frames.map((frame) => [(25 * frame) / 30, 0, -100 + (2 * frame) / 30]);
  const horizon = frames.map((frame) => [frame, [0, 400 + frame, 1280, 400 + frame]]);
  const plan = {frames, horizon, own: {ned}} as never;
  for (const frame of [0, 62, 149]) {
    const table = newFlyer(
        {kind: 'aircraft', aircraft: '738/738-ANA', length_m: 39.5}, {lens: {focal_px: [900, 900]}}, CLIP, frame,
        [300, 200], plan);
    const heights = momentsOf(flyer(table), CLIP).map(({frame: at, pixel: [x, y], range_m}) => {
      const above_m = ((400 + at - y) * range_m!) / Math.hypot(900, x - 640, y - 480);
      return 100 - (2 * at) / 30 + above_m;
    });
    near(heights[1], heights[0], 0.1);
    same(momentsOf(flyer(table), CLIP).find((one) => one.frame === frame)?.pixel, [300, 200]);
  }
};
tests['A moment stands in its place in time, or moves the one that is there'] = () => {
  const one = flyer(
      {aircraft: 'a', seen: [{time_s: 0, pixel: [1, 1], range_m: 100}, {time_s: 2, pixel: [2, 2], width_px: 30}]});
  same(
      withMoment(one, CLIP, 30, [5, 5], 120),
      {changes: [{insert: ['intruder', 0, 'seen'], at: 1, table: {time_s: 1, pixel: [5, 5], range_m: 120}}], index: 1});
  same(withMoment(one, CLIP, 60, [5.04, 5], 120).changes, [{set: ['intruder', 0, 'seen', 1, 'pixel'], to: [5, 5]}]);
  const moments = momentsOf(one, CLIP);
  same(
      moments.map((moment) => nearer(moment, 2)),
      [{set: ['intruder', 0, 'seen', 0, 'range_m'], to: 50}, {set: ['intruder', 0, 'seen', 1, 'width_px'], to: 60}]);
};
tests['Another statement takes the place of the first'] = () => {
  const one = flyer({aircraft: 'a', encounter: {cpa_time_s: 1}, start_s: 1});
  const changes = toMoments(one, track((k) => [k, k]), CLIP)!;
  same(
      changes.filter((change) => 'remove' in change),
      [{remove: ['intruder', 0, 'encounter']}, {remove: ['intruder', 0, 'start_s']}]);
  same(
      changes.flatMap((change) => ('insert' in change ? [[change.at, change.table.time_s]] : [])),
      [[0, 0], [1, 2.467], [2, 4.967]]);
};
tests['A closest approach beyond the clip is where both go straight on'] = () => {
  const at = (north: number, east: number): [number, number, number] => [north, east, -150];
  const plan = {frames: [0, 149], own: {ned: [at(0, 0), at(149, 0)]}} as unknown as Plan;
  const other: Track = {
    ...track((k) => [k, k]),
    ned: [at(1000, 10), at(702, 10)],
    cpa: {time_s: 149 / 30, range_m: 553, ahead_m: 553, right_m: 10, above_m: 0} as unknown as Track['cpa'],
  };
  const changes = toApproach(flyer({aircraft: 'a'}), other, plan, CLIP)!;
  same(
      changes.flatMap((change) => ('set' in change ? [[change.set[3], change.to]] : [])),
      [['cpa_time_s', 11.11], ['cpa_right_m', 10], ['cpa_above_m', 0], ['course_deg', 180], ['speed_mps', 60]]);
};
tests['A copy stands beside the one it is of'] = () => {
  const copy = copyOf(flyer({id: 'a', waypoints_ned_m: [[300, -60, -170], [400, 0, -170]]}), CLIP);
  same(copy, {waypoints_ned_m: [[300, -60, -190], [400, 0, -190]]});
  same(copyOf(flyer({position_ned_m: [1, 2, -3]}), CLIP), {position_ned_m: [1, 2, -23]});
};
tests['Flyers have names, kinds and statements'] = () => {
  const all = flyersOf({
    intruder: [{aircraft: 'x', encounter: {}}, {id: 'me', aircraft: 'y', path_file: 'p'}],
    distractor: [{kind: 'bird', count: 4, seen: []}, {kind: 'dirt'}]
  });
  same(all.map((one) => [one.id, one.kind, one.statement, one.title]), [
    ['intruder-1', 'aircraft', 'approach', 'x'], ['me', 'aircraft', 'file', 'y'],
    ['bird-1', 'bird', 'moments', '4 birds'], ['dirt-1', 'dirt', 'lens', 'dirt']
  ]);
};

tests['A moment has room between the two beside it'] = () => {
  const moments = momentsOf(flyer({seen: [0.1, 1, 2].map((time_s) => ({time_s, pixel: [1, 1], range_m: 9}))}), CLIP);
  same([0, 1, 2].map((k) => roomOf(moments, k, CLIP)), [[0, 29], [4, 59], [31, 149]]);
};
tests['A label stands in the room and beside what is there'] = () => {
  const room: [number, number, number, number] = [0, 0, 100, 50];
  same(freePlace([20, 10], [[90, 5], [30, 5]], room, []), [30, 5, 20, 10]);
  same(freePlace([20, 10], [[10, 5], [60, 5]], room, [[25, 0, 10, 10]]), [60, 5, 20, 10]);
  same(freePlace([20, 10], [[90, -5]], room, []), [80, 0, 20, 10]);
};
tests['How long a flyer is in view'] = () => {
  const one = track(() => [1, 1]);
  one.points.forEach((point) => {
    point[5] = (point[0] >= 30 && point[0] < 60) || point[0] >= 135;
  });
  same(describedView(one, {frames: [0, 1]} as never, CLIP), 'In view for 1.5 s, between 1 and 5 s.');
  one.points = one.points.filter((_, k) => k % 15 === 0);
  same(describedView(one, {frames: [0, 15]} as never, CLIP), 'In view for 1.5 s, between 1 and 4.5 s.');
  same(describedView({...one, points: []}, {frames: [0]} as never, CLIP), '');
};

async function run(): Promise<string[]> {
  const faults: string[] = [];
  for (const [name, test] of Object.entries(tests)) {
    try {
      await test();
    } catch (error) {
      faults.push(`${name}: ${(error as Error).message}`);
    }
  }
  return faults.length ? faults : [`${Object.keys(tests).length} good`];
}
Object.assign(window, {modelTest: run()});
