// SPDX-License-Identifier: Apache-2.0
import type {Clip, MeasuredValue, NearMiss, Path, PictureHeader, Plan, Rendered, State} from './contract';

// A line for the user; what is said twice is shown once.
export interface Notice {
  kind: 'error'|'warning'|'info';
  line: string;
}

export interface Progress {
  of: string;
  done: number;
  total: number;
}

// The part of the frame that is shown: its pixel at the stage's top-left corner, and screen pixels a frame pixel. None:
// all of it.
export interface Look {
  x: number;
  y: number;
  scale: number;
}

export type Tab = 'flyers'|'light'|'camera'|'text';

// A handle that is dragged stands where the pointer is, whatever the server has answered so far.
export interface Draft {
  path: Path;
  pixel: [number, number];
}

// What was asked for, through the pixel of a frame.
export interface MadeNearMiss {
  asked: NearMiss;
  frame: number;
}

// All that the page knows, as it is at the beginning. Parts read it and are told which members changed.
const beginning = {
  connected: false,
  everConnected: false,
  refused: false,  // the first attempt to connect failed
  file: '',
  out: '',  // the folder of rendered videos
  clip: null as Clip | null,
  state: null as State | null,
  plan: null as Plan | null,
  planProblem: null as string | null,     // why there is no plan of the scene as it is
  picture: null as PictureHeader | null,  // of the picture that is shown: its boxes and lines
  pending: 0,                             // edits that the server has not answered
  notices: [] as Notice[],
  progress: null as Progress | null,
  busy: null as 'render' | 'calibrate' | null,
  measured: null as MeasuredValue[] | null,
  film: null as Rendered | null,
  nearMisses: {} as {[encounter: string]: MadeNearMiss},  // by what they became
  // view settings
  frame: 0,
  playing: false,
  speed: 1,
  selected: null as Path | null,
  moment: null as number | null,
  draft: null as Draft | null,
  look: null as Look | null,
  tab: 'flyers' as Tab,
  showsAircraft: true,
  showsBoxes: true,
  showsHorizon: false,
  showsMotion: false,
  dialog: null as 'gallery' | 'render' | 'help' | null,
  addsAt: null as [number, number] | null,  // where the gallery's choice is put
  replaces: null as Path | null,            // the flyer whose aircraft the gallery changes
};

export type Everything = typeof beginning;
export type Member = keyof Everything;

// What a reload of the page keeps.
const KEPT: Member[] = [
  'nearMisses', 'frame', 'selected', 'moment', 'tab', 'showsAircraft', 'showsBoxes', 'showsHorizon', 'showsMotion',
  'speed'
];
const KEY = 'airtruth-studio-view';

type Listener = (changed: Set<Member>) => void;

export class Store {
  readonly now: Readonly<Everything>;
  private values: Everything;
  private listeners = new Set<Listener>();
  private changed = new Set<Member>();
  private isTold = true;

  constructor(private kept: Storage|null = null) {
    this.values = {...beginning, ...this.remembered()};
    this.now = this.values;
  }

  // Takes new values; listeners are told once, at the end of the running task.
  put(values: Partial<Everything>): void {
    for (const [key, value] of Object.entries(values) as [Member, never][]) {
      if (this.values[key] === value) continue;
      this.values[key] = value;
      this.changed.add(key);
    }
    if (!this.changed.size || !this.isTold) return;
    this.isTold = false;
    queueMicrotask(() => this.tell());
  }

  listen(listener: Listener): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  say(kind: Notice['kind'], line: string): void {
    const others = this.values.notices.filter((notice) => notice.line !== line);
    this.put({notices: [...others, {kind, line}].slice(-4)});
  }

  unsay(line: string): void {
    this.put({notices: this.values.notices.filter((notice) => notice.line !== line)});
  }

  private tell(): void {
    this.isTold = true;
    const changed = this.changed;
    this.changed = new Set();
    if (KEPT.some((key) => changed.has(key))) this.remember();
    for (const listener of [...this.listeners]) listener(changed);
  }

  private remember(): void {
    this.kept?.setItem(KEY, JSON.stringify(Object.fromEntries(KEPT.map((key) => [key, this.values[key]]))));
  }

  private remembered(): Partial<Everything> {
    try {
      return JSON.parse(this.kept?.getItem(KEY) ?? '{}');
    } catch {
      return {};
    }
  }
}
