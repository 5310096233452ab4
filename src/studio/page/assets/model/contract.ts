// SPDX-License-Identifier: Apache-2.0
// What the server and the page say to each other (src/studio/server). Pixels are the frame's own, from its top-left corner; times are
// seconds from the first frame that the scene uses; places are north-east-down in metres.

export type Path = (string | number)[];
export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
export type Table = { [key: string]: Json };

export type Change = { set: Path; to: Json } | { remove: Path } | { insert: Path; at: number | null; table: Table };

export interface Clip {
  width: number;
  height: number;
  frames: number;
  rate_hz: number;
  first_frame: number;
  duration_s: number;
}

export interface State {
  revision: number;
  text: string;
  scene: Table;
  problem: string | null;
  saved: boolean;
  undo: number;
  redo: number;
  changed_on_disk: boolean;
}

export interface Handle {
  path: Path;
  frame: number;
  pixel: [number, number];
  range_m: number;
  width_px: number;
}

export interface Approach {
  time_s: number;
  right_m: number;
  above_m: number;
  ahead_m: number;
  distance_m: number;
}

// frame, x, y, range_m, width_px, visible
export type TrackPoint = [number, number, number, number, number, boolean | number];
export type Ned = [number, number, number];

export interface Track {
  table: Path;
  id: string;
  points: TrackPoint[];
  ned: (Ned | null)[];
  handles: Handle[];
  cpa: Approach | null;
  checks: string[];
}

export interface Volume {
  name: string;
  horizontal_m: number;
  vertical_m: number;
}

export interface Plan {
  revision: number;
  frames: number[];
  own: { ned: Ned[] };
  tracks: Track[];
  horizon: [number, [number, number, number, number]][];
  volumes: Volume[];
  checks?: string[];
}

export interface AircraftGroup {
  name: string;
  kind: 'aircraft' | 'bird' | 'multirotor' | 'balloon';
  length_m: number;
  span_m: number;
  liveries: string[];
}

export interface MeasuredValue {
  key: string;
  value: Json;
  error: Json;
  unit: string;
}

export interface PictureHeader {
  id: number;
  frame: number;
  revision: number;
  crop: [number, number, number, number] | null;
  scale: number;
}

export interface Picture {
  header: PictureHeader;
  jpeg: Blob;
}

export type ServerEvent =
  | { event: 'state'; state: State }
  | { event: 'progress'; of: string; done: number; total: number }
  | { event: 'warning'; line: string };
