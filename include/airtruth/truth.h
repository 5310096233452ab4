// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <airtruth/box.h>
#include <airtruth/export.h>
#include <airtruth/lens.h>

// The truth of a frame, and its file truth.jsonl (docs/formats/truth.md). Positions in the world
// are north, east, down in metres; in the camera x right, y down, z forward.
//
// Example: an intruder 800 m ahead of the camera and 40 m to its left, at the same height, that
// flies to the right at 40 m/s past a camera at rest. position_in_cam_m = {-40, 0, 800}, range_m =
// 801.0, range_rate_mps = -40 * 40 / 801.0 = -2.0, azimuth_deg = atan2(-40, 800) = -2.86 and
// elevation_deg = 0.
namespace airtruth {

enum class IntruderState {
  // At least one pixel shows it.
  kVisible,
  // It is in the view, but no pixel shows it: something hides it, or it is too faint.
  kHidden,
  // It is in front of the camera, but outside the image or the lens's valid field.
  kOutside,
  kBehind,
  // Its path has not begun or is over: it is not in the world.
  kEnded,
};

// Whether an intruder violates a volume of airspace that the scene asks for.
struct VolumeTruth {
  std::string name;
  bool inside = false;
  // Time to the violation if both keep their velocities; 0 inside, empty where there is none within
  // the lookahead.
  std::optional<double> to_violation_s;

  bool operator==(const VolumeTruth&) const = default;
};

// The measures of detect-and-avoid between the own aircraft on its nominal path and an intruder, if
// both keep their velocities (docs/formats/truth.md). A measure that is not defined is empty.
struct EncounterTruth {
  // Distance over the ground; how much higher the intruder is.
  double horizontal_m = 0;
  double above_m = 0;
  std::optional<double> closing_speed_mps;
  // Direction of the intruder from north towards east, 0 to 360, and from the own course.
  std::optional<double> bearing_deg;
  std::optional<double> bearing_rate_dps;
  std::optional<double> relative_bearing_deg;
  std::optional<double> line_of_sight_rate_dps;
  // Time to the horizontal closest approach, and the horizontal distance there.
  std::optional<double> tcpa_s;
  std::optional<double> dcpa_m;
  // Least horizontal distance and least difference of height within the lookahead.
  double hmd_m = 0;
  double vmd_m = 0;
  // Modified tau with a DMOD of 0.66 nmi; time to the same height.
  std::optional<double> tau_mod_s;
  std::optional<double> tcoa_s;
  std::vector<VolumeTruth> volumes;

  bool operator==(const EncounterTruth&) const = default;
};

// The truth of one intruder in one frame. The optional fields are all empty in the state kEnded.
struct IntruderTruth {
  std::string id;
  // Name in the catalogue of aircraft, path of the model from the scene's folder, or the class of a
  // distractor (docs/formats/truth.md).
  std::string aircraft;
  IntruderState state = IntruderState::kEnded;
  std::optional<std::array<double, 3>> position_ned_m;
  std::optional<std::array<double, 3>> velocity_ned_mps;
  std::optional<std::array<double, 3>> attitude_yaw_pitch_roll_deg;
  // In the measured camera where motion is a rotation, else in the nominal one.
  std::optional<std::array<double, 3>> position_in_cam_m;
  std::optional<double> range_m;
  // Negative while the range decreases.
  std::optional<double> range_rate_mps;
  // Bearing in the camera as it was in this frame; right and up are positive.
  std::optional<double> azimuth_deg;
  std::optional<double> elevation_deg;
  // Bearing from the boresight of the nominal, unshaken camera.
  std::optional<double> nominal_azimuth_deg;
  std::optional<double> nominal_elevation_deg;
  // Empty where the intruder is not in the world.
  std::optional<EncounterTruth> encounter;
  // Box of the projected geometry, of one that reaches behind the camera with the covered box; not
  // clipped by the frame.
  std::optional<Box> exact_box_px;
  // Bounds of the whole pixels that the intruder covers with an alpha of 0.08 or more: the box for
  // training and scoring.
  std::optional<PixelBox> covered_box_px;
  // Number of those pixels; empty without that box.
  std::optional<std::int64_t> covered_area_px;
  // Bounds of the pixels that changed; present exactly where the state is kVisible.
  std::optional<PixelBox> visible_box_px;
  // Root mean square difference of the covered box (else the visible one) from its surroundings
  // over their noise, in the picture before it is encoded; empty without surroundings.
  std::optional<double> contrast_to_noise;
  // Number of pixels that changed.
  std::int64_t visible_area_px = 0;
  // Sum of the visible coverage, in pixels, and its centroid.
  double alpha_sum_px = 0;
  std::optional<std::array<double, 2>> centroid_px;
  // Shares of the intruder's silhouette, 0..1.
  double hidden_by_own_aircraft = 0;
  // Empty where the scene has no [[occluder]].
  std::optional<double> hidden_by_occluder;
  double hidden_by_intruder = 0;
  double cut_by_frame = 0;
  // "aircraft", or what a detector may take for one: "bird", "multirotor", "balloon", "glint",
  // "dirt" or "insect". The last three are on the lens and have no place in the world: of the
  // optional fields they have only boxes and a centroid.
  std::string object_class = "aircraft";

  bool operator==(const IntruderTruth&) const = default;
};

// The truth of one frame.
struct FrameTruth {
  // From 0: the n-th frame of the sequence.
  std::int64_t frame = 0;
  double time_s = 0;
  // True where the background's frame came from corrupt data.
  bool damaged = false;
  // The nominal, unshaken camera.
  std::array<double, 3> camera_position_ned_m{};
  std::array<double, 3> camera_attitude_yaw_pitch_roll_deg{};
  // "reference", "measured", "bridged", "cut", "turned_away" or "none".
  std::string motion_state = "reference";
  // Row by row: a pixel of the nominal picture times this matrix, divided by the third component,
  // is the pixel of the frame.
  std::array<double, 9> frame_from_reference{1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<double, 9> frame_from_reference_per_s{};
  // Quaternion w, x, y, z that takes a direction from the nominal camera's axes to the measured
  // one's, where motion is a rotation, and its rate: R(t + dt) = exp(rate dt) R(t).
  std::optional<std::array<double, 4>> rotation;
  std::array<double, 3> rate_radps{};
  // In the order of the scene.
  std::vector<IntruderTruth> intruders;

  bool operator==(const FrameTruth&) const = default;
};

// A whole truth.jsonl.
struct SequenceTruth {
  Lens lens;
  std::vector<FrameTruth> frames;
};

// Reads truth.jsonl. Errors carry file and line.
AIRTRUTH_API SequenceTruth read_truth(const std::filesystem::path& file);

// One line of truth.jsonl, without the newline. Each number is the shortest text that parses to the
// same double.
AIRTRUTH_API std::string truth_line(const FrameTruth& truth, const Lens& lens);

}  // namespace airtruth
