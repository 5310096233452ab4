// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/geometry/transform.h"
#include "foundation/geometry/within_frame.h"

// The truth of a frame, and truth.jsonl (docs/formats/truth.md, docs/formats/truth.schema.json).
namespace airtruth::annotation {

enum class State {
  kVisible,  // at least one pixel of the frame shows it
  kHidden,  // in the view, but not one pixel shows it: behind the own aircraft or another intruder,
            // or too faint
  kOutside,  // in front of the camera, outside the image (or outside the lens's valid field)
  kBehind,   // behind the camera
  kEnded,    // its path has not begun or is over: it is not in the world
};
const char* name(State state);  // "visible", ...

struct Intruder {
  std::string id;
  std::string aircraft;  // catalogue name or file name of the model
  State state = State::kEnded;
  // All empty when the state is kEnded.
  std::optional<Vector3> position_ned_m;
  std::optional<Vector3> velocity_ned_mps;
  std::optional<YawPitchRoll> attitude_yaw_pitch_roll_deg;
  // x right, y down, z forward; in the measured camera where motion is a rotation, else in the
  // nominal one (a homography belongs to the picture: frame_from_reference then moves its pixel).
  std::optional<Vector3> position_in_cam_m;
  std::optional<double> range_m;
  std::optional<double> range_rate_mps;  // negative: closing
  // Of the reference point, in the camera as it really looked in this frame: the ray of the pixel
  // where the point is drawn (bearing.h). Right and up are positive. Both or neither.
  std::optional<double> azimuth_deg;
  std::optional<double> elevation_deg;
  // The same from the boresight of the nominal, unshaken camera: no pixel lies there.
  std::optional<double> nominal_azimuth_deg;
  std::optional<double> nominal_elevation_deg;
  // From projected geometry, not clipped by the frame; empty behind the camera or beyond the lens's
  // field.
  std::optional<Box> exact_box_px;
  // Bounds of the whole pixels that the intruder covers with at least composite::kCoveredAlpha:
  // exposure and point spread count, what hides it is taken away, and what sharpening, noise and
  // the codec do to the samples does not count. Only where the state is kVisible; empty where no
  // pixel reaches that alpha.
  std::optional<PixelBox> covered_box_px;
  // From the pixels that changed; present exactly when the state is kVisible.
  std::optional<PixelBox> visible_box_px;
  std::int64_t visible_area_px = 0;   // pixels that changed
  double alpha_sum_px = 0;            // coverage seen, in pixels
  std::optional<Pixel> centroid_px;   // of that coverage, over the exposure; empty: none is seen
  double hidden_by_own_aircraft = 0;  // fractions of its silhouette, 0..1
  double hidden_by_intruder = 0;
  double cut_by_frame = 0;
};

// Where to point at an intruder: its covered box, or the visible one where it covers no pixel far
// enough to have one; empty where it is not visible.
inline std::optional<PixelBox> box_to_show(const Intruder& intruder) {
  return intruder.covered_box_px ? intruder.covered_box_px : intruder.visible_box_px;
}

struct Frame {
  std::int64_t frame = 0;
  double time_s = 0;
  bool damaged = false;  // the background's frame came from corrupt data
  Vector3 camera_position_ned_m = Vector3::Zero();
  YawPitchRoll camera_attitude_yaw_pitch_roll_deg;
  Shake shake;
  std::string motion_state = "reference";
  std::vector<Intruder> intruders;
};

struct LensFacts {
  std::string model;
  std::array<double, 2> focal_px{};
  std::array<double, 2> principal_point_px{};
  std::vector<double> distortion;
  int width = 0;
  int height = 0;
};

// One line of truth.jsonl, without the newline. Numbers are shortest round-trip; NaN and infinity
// never appear (check()).
std::string jsonl_line(const Frame& frame, const LensFacts& lens);

// Reads it back. Errors carry file and line.
Frame parse_jsonl_line(std::string_view line, const std::filesystem::path& file, int line_number);
struct Truth {
  LensFacts lens;
  std::vector<Frame> frames;
};
Truth read_truth(const std::filesystem::path& file);

}  // namespace airtruth::annotation
