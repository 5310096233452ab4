// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <airtruth/truth.h>

#include "encounter/separation/measures.h"
#include "foundation/base/names.h"
#include "foundation/geometry/box.h"
#include "foundation/geometry/transform.h"
#include "foundation/geometry/within_frame.h"

namespace airtruth {

constexpr auto enum_names(IntruderState) {
  return std::to_array<EnumName<IntruderState>>({{IntruderState::kVisible, "visible"},
                                                 {IntruderState::kHidden, "hidden"},
                                                 {IntruderState::kOutside, "outside"},
                                                 {IntruderState::kBehind, "behind"},
                                                 {IntruderState::kEnded, "ended"}});
}

}  // namespace airtruth

// The truth of a frame, and its file truth.jsonl (docs/formats/truth.md,
// docs/formats/truth.schema.json).
//
// Example: an intruder 800 m ahead of the camera and 40 m to its left, at the same height, that
// flies to the right at 40 m/s past a camera at rest. position_in_cam_m = (-40, 0, 800), range_m =
// 801.0, range_rate_mps = -40 * 40 / 801.0 = -2.0, azimuth_deg = atan2(-40, 800) = -2.86 and
// elevation_deg = 0.
namespace airtruth::annotation {

using State = IntruderState;
using airtruth::VolumeTruth;

// How an intruder stands to the own aircraft on its nominal path.
struct EncounterTruth {
  separation::Measures measures;
  std::vector<VolumeTruth> volumes;
};

// The truth of one intruder in one frame.
struct Intruder {
  std::string id;
  // Name in the catalogue, or file name of the model.
  std::string aircraft;
  State state = State::kEnded;
  // The optional fields are all empty when the state is kEnded.
  std::optional<Vector3> position_ned_m;
  std::optional<Vector3> velocity_ned_mps;
  std::optional<YawPitchRoll> attitude_yaw_pitch_roll_deg;
  // x right, y down, z forward. The camera is the measured one where motion is a rotation, else the
  // nominal one: a homography moves the picture and not the camera, and frame_from_reference then
  // moves the pixel.
  std::optional<Vector3> position_in_cam_m;
  std::optional<double> range_m;
  // Negative while the range decreases.
  std::optional<double> range_rate_mps;
  // Bearing of the reference point in the camera as it was in this frame: the direction of the ray
  // through the pixel where the point is drawn (bearing.h). Right and up are positive. Both are
  // present or neither.
  std::optional<double> azimuth_deg;
  std::optional<double> elevation_deg;
  // The same bearing from the boresight of the nominal, unshaken camera. It corresponds to no
  // pixel.
  std::optional<double> nominal_azimuth_deg;
  std::optional<double> nominal_elevation_deg;
  // Empty in older files.
  std::optional<EncounterTruth> encounter;
  // Box of the projected geometry, not clipped by the frame; empty behind the camera or beyond the
  // lens's field.
  std::optional<Box> exact_box_px;
  // Bounds of the whole pixels that the intruder covers with at least composite::kCoveredAlpha.
  // Exposure and point spread count, and whatever hides the intruder is subtracted; the effects of
  // sharpening, noise and the codec on the samples do not count. Present only where the state is
  // kVisible; empty where no pixel reaches that alpha.
  std::optional<PixelBox> covered_box_px;
  // Number of those pixels; empty without that box, and in older files.
  std::optional<std::int64_t> covered_area_px;
  // Bounds of the pixels that changed; present exactly where the state is kVisible.
  std::optional<PixelBox> visible_box_px;
  // How much box_to_show() stands out from its surroundings in the picture before it is encoded
  // (foundation/image/contrast_to_noise.h); empty where it is not visible, where the surroundings
  // are too few pixels, and in older files.
  std::optional<double> contrast_to_noise;
  // Number of pixels that changed.
  std::int64_t visible_area_px = 0;
  // Sum of the visible coverage, in pixels.
  double alpha_sum_px = 0;
  // Centroid of that coverage over the exposure; empty where there is none.
  std::optional<Pixel> centroid_px;
  // Shares of the intruder's silhouette, 0..1.
  double hidden_by_own_aircraft = 0;
  // By what else the scene says stands before it; empty where it says nothing.
  std::optional<double> hidden_by_occluder;
  double hidden_by_intruder = 0;
  double cut_by_frame = 0;
  // One of object_class.h. What is on the lens has no place in the world: of the optional fields it
  // has only boxes and a centroid.
  std::string object_class = "aircraft";
};

// The box that marks an intruder for a viewer: its covered box, or the visible box where no pixel
// reaches the covered box's alpha. Empty where the intruder is not visible.
inline std::optional<PixelBox> box_to_show(const Intruder& intruder) {
  return intruder.covered_box_px ? intruder.covered_box_px : intruder.visible_box_px;
}

// The truth of one frame.
struct Frame {
  std::int64_t frame = 0;
  double time_s = 0;
  // True where the background's frame came from corrupt data.
  bool damaged = false;
  Vector3 camera_position_ned_m = Vector3::Zero();
  YawPitchRoll camera_attitude_yaw_pitch_roll_deg;
  Shake shake;
  std::string motion_state = "reference";
  std::vector<Intruder> intruders;
};

// The lens, as each line of truth.jsonl states it.
struct LensFacts {
  std::string model;
  std::array<double, 2> focal_px{};
  std::array<double, 2> principal_point_px{};
  std::vector<double> distortion;
  int width = 0;
  int height = 0;
};

// One line of truth.jsonl, without the newline. Each number is the shortest text that parses to the
// same double. NaN and infinity fail a check().
std::string jsonl_line(const Frame& frame, const LensFacts& lens);

// Parses such a line. Errors carry file and line.
Frame parse_jsonl_line(std::string_view line, const std::filesystem::path& file, int line_number);
struct Truth {
  LensFacts lens;
  std::vector<Frame> frames;
};
Truth read_truth(const std::filesystem::path& file);

// Describes the first inconsistency of a frame's truth; empty where it is consistent. The rules
// are: a visible box is present exactly where the intruder is visible, a position is present
// exactly where it is in the world, and fractions lie within 0..1.
std::optional<std::string> fault(const Frame& frame);

}  // namespace airtruth::annotation
