// SPDX-License-Identifier: Apache-2.0
// What the server and the page say to each other (src/studio/server). Pixels are the frame's own, from its top-left
// corner; times are seconds from the first frame that the scene uses; places are north-east-down in metres.

export type Path = (string|number)[];
export type Json = null|boolean|number|string|Json[]|{[key: string]: Json};
export type Table = {
  [key: string]: Json
};

export type Change = {
  set: Path; to: Json
}|{remove: Path}|{
  insert: Path;
  at: number|null;
  table: Table
};

export interface Clip {
  video: string;
  width: number;
  height: number;
  frames: number;
  rate_hz: number;
  begin_s: number;    // of the video, when it shows the first frame
  times_s: number[];  // of the frames, where the rate is not constant; else empty
  first_frame: number;
}

export interface State {
  revision: number;
  text: string;
  sha256: string;  // of the text
  scene: Table;
  notes: {[key: string]: string};  // the comments of the file on its tables and keys, by their dotted names
  problem: string|null;
  saved: boolean;
  undo: number;
  redo: number;
  changed_on_disk: boolean;
  journal_fault: string|null;
}

// The same as the server has it: of a text that is no TOML there is no scene.
export interface Told extends Omit<State, 'scene'> {
  scene: Table|null;
}

export interface Handle {
  frame: number;
  pixel: [number, number];
  range_m: number|null;
  width_px: number|null;
}

// A path past the own aircraft; above_m is null of a level one.
export interface NearMiss {
  miss_m: number;
  right: boolean;
  speed_mps: number;
  above_m: number|null;
}

export interface Approach {
  time_s: number;
  right_m: number;
  above_m: number;
  ahead_m: number;
  distance_m: number;
}

// frame, x, y, range_m, width_px, visible; without a place where the lens has none, and without a width where there is
// no box
export type TrackPoint = [number, number | null, number | null, number, number | null, boolean];
export type Ned = [number, number, number];

export interface Track {
  table: Path;
  id: string;
  points: TrackPoint[];
  ned: (Ned|null)[];
  handles: Handle[];
  cpa: Approach|null;
  checks: string[];
  approach: string;  // the command line's words, of a flock those of its middle
}

export interface Volume {
  name: string;
  horizontal_m: number;
  vertical_m: number;
}

export interface Plan {
  complete: boolean;  // nothing is left to be measured
  frames: number[];
  // velocity_mps, and attitude_deg (yaw, pitch and roll): in the first frame
  own: {ned: Ned[]; velocity_mps: Ned; heading_deg: number; attitude: string; attitude_deg: Ned};
  horizontal_fov_deg: number;
  tracks: Track[];
  horizon: [number, [number, number, number, number]][];
  volumes: Volume[];
  warnings: string[];
}

export interface AircraftGroup {
  name: string;
  type: string;  // published
  length_m: number|null;
  span_m: number|null;
  class: string;       // of its flight limits: "airliner"
  liveries: string[];  // at least one, each a name for /aircraft.jpg
}

export interface MeasuredValue {
  key: string;
  value: Json;
  error: Json;
  missing: string;  // why there is no value
}

// frame, x, y; without a place where the lens has none
export type LinePoint = [number, number | null, number | null];

export interface PictureHeader {
  id: number;
  frame: number;
  revision: number;
  crop: BoxPx;
  scale: number;
  boxes: ExactBox[];
  // The paths as the camera of this frame would see them at other times.
  lines: {table: Path; points: LinePoint[]}[];
  directions: [number, number, number, number][];  // of the world: azimuth and elevation in degrees, x, y
  problem: string|null;                            // why there is nothing in it but the clip
}

export type BoxPx = [number, number, number, number];

// What render() wrote, and the boxes in its frames.
export interface Rendered {
  folder: string;
  video: string;
  boxes: [number, FilmBox[]][];
}

export interface FilmBox {
  id: string;
  box: BoxPx;
}

export interface ExactBox extends FilmBox {
  table: Path;
  range_m: number;
}

export interface Picture {
  header: PictureHeader;
  jpeg: Blob;
}

export type ServerEvent =|{
  event: 'state';
  state: Told
}
|{
  event: 'progress';
  of: string;
  done: number;
  total: number
}
|{
  event: 'measured';
  of: string
}
|{
  event: 'warning';
  line: string
};
