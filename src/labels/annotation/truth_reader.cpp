// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/json/json_object.h"
#include "labels/annotation/truth.h"
#include "labels/annotation/truth_rules.h"

namespace airtruth::annotation {
namespace {

// Largest position or size in pixels, far below the values whose sums overflow an int.
constexpr std::int64_t kLargestTruthPixel = 1 << 29;

int pixels(const JsonObject& object, const char* key) {
  return static_cast<int>(object.whole(key, -kLargestTruthPixel, kLargestTruthPixel));
}

template <std::size_t n>
std::array<double, n> tuple(const JsonObject& object, const char* key) {
  const std::vector<double> numbers = object.numbers(key, n);
  std::array<double, n> result{};
  std::copy(numbers.begin(), numbers.end(), result.begin());
  return result;
}

Vector3 vector(const JsonObject& object, const char* key) {
  const auto v = tuple<3>(object, key);
  return {v[0], v[1], v[2]};
}

YawPitchRoll attitude(const JsonObject& object, const char* key) {
  const auto v = tuple<3>(object, key);
  return {v[0], v[1], v[2]};
}

std::optional<Vector3> maybe_vector(const JsonObject& object, const char* key) {
  return object.has(key) ? std::optional(vector(object, key)) : std::nullopt;
}

std::optional<YawPitchRoll> maybe_attitude(const JsonObject& object, const char* key) {
  return object.has(key) ? std::optional(attitude(object, key)) : std::nullopt;
}

Homography homography(const JsonObject& object, const char* key) {
  const std::vector<double> numbers = object.matrix(key, 3, 3);
  Homography h;
  for (int i = 0; i < 9; ++i) h(i / 3, i % 3) = numbers[static_cast<std::size_t>(i)];
  return h;
}

std::optional<PixelBox> pixel_box(const JsonObject& object, const char* key) {
  if (!object.has(key)) return std::nullopt;
  const auto v = object.wholes(key, 4, -kLargestTruthPixel, kLargestTruthPixel);
  return PixelBox{static_cast<int>(v[0]),
                  static_cast<int>(v[1]),
                  static_cast<int>(v[2]),
                  static_cast<int>(v[3])};
}

State state_from(const JsonObject& object) {
  const std::string word = object.text("state");
  for (const State state :
       {State::kVisible, State::kHidden, State::kOutside, State::kBehind, State::kEnded})
    if (word == name(state)) return state;
  object.fail("state", "visible, hidden, outside, behind or ended");
}

EncounterTruth encounter_from(const JsonObject& object, const std::optional<double>& range_m) {
  EncounterTruth truth;
  encounter::Measures& m = truth.measures;
  m.range_m = range_m.value_or(0);
  m.horizontal_m = object.number("horizontal_m");
  m.above_m = object.number("above_m");
  m.closing_speed_mps = object.maybe_number("closing_speed_mps");
  m.bearing_deg = object.maybe_number("bearing_deg");
  m.bearing_rate_dps = object.maybe_number("bearing_rate_dps");
  m.relative_bearing_deg = object.maybe_number("relative_bearing_deg");
  m.line_of_sight_rate_dps = object.maybe_number("line_of_sight_rate_dps");
  m.tcpa_s = object.maybe_number("tcpa_s");
  m.dcpa_m = object.maybe_number("dcpa_m");
  m.hmd_m = object.number("hmd_m");
  m.vmd_m = object.number("vmd_m");
  m.tau_mod_s = object.maybe_number("tau_mod_s");
  m.tcoa_s = object.maybe_number("tcoa_s");
  for (const JsonObject& volume : object.objects("volumes"))
    truth.volumes.push_back(
        {volume.text("name"), volume.truth("inside"), volume.maybe_number("to_violation_s")});
  return truth;
}

Intruder intruder_from(const JsonObject& object) {
  Intruder intruder;
  intruder.id = object.text("id");
  intruder.aircraft = object.text("aircraft");
  intruder.object_class = object.maybe_text("class").value_or(intruder.object_class);
  intruder.state = state_from(object);
  intruder.position_ned_m = maybe_vector(object, "position_ned_m");
  intruder.velocity_ned_mps = maybe_vector(object, "velocity_ned_mps");
  intruder.attitude_yaw_pitch_roll_deg = maybe_attitude(object, "attitude_yaw_pitch_roll_deg");
  intruder.position_in_cam_m = maybe_vector(object, "position_in_cam_m");
  intruder.range_m = object.maybe_number("range_m");
  intruder.range_rate_mps = object.maybe_number("range_rate_mps");
  intruder.azimuth_deg = object.maybe_number("azimuth_deg");
  intruder.elevation_deg = object.maybe_number("elevation_deg");
  intruder.nominal_azimuth_deg = object.maybe_number("nominal_azimuth_deg");
  intruder.nominal_elevation_deg = object.maybe_number("nominal_elevation_deg");
  if (object.has("encounter"))
    intruder.encounter = encounter_from(object.object("encounter"), intruder.range_m);
  if (object.has("exact_box_px")) {
    const auto box = tuple<4>(object, "exact_box_px");
    intruder.exact_box_px = Box{box[0], box[1], box[2], box[3]};
  }
  intruder.covered_box_px = pixel_box(object, "covered_box_px");
  intruder.visible_box_px = pixel_box(object, "visible_box_px");
  intruder.visible_area_px = object.whole("visible_area_px");
  intruder.alpha_sum_px = object.number("alpha_sum_px");
  if (object.has("centroid_px")) {
    const auto at = tuple<2>(object, "centroid_px");
    intruder.centroid_px = Pixel(at[0], at[1]);
  }
  intruder.hidden_by_own_aircraft = object.number("hidden_by_own_aircraft");
  intruder.hidden_by_intruder = object.number("hidden_by_intruder");
  intruder.cut_by_frame = object.number("cut_by_frame");
  return intruder;
}

Shake shake_from(const JsonObject& motion) {
  Shake shake;
  shake.frame_from_reference = homography(motion, "frame_from_reference");
  if (motion.has("rotation")) {
    const auto q = tuple<4>(motion, "rotation");
    shake.rotation = Quaternion(q[0], q[1], q[2], q[3]);
  }
  if (motion.has("rate_radps")) shake.rate_radps = vector(motion, "rate_radps");
  if (motion.has("frame_from_reference_per_s"))
    shake.frame_from_reference_per_s = homography(motion, "frame_from_reference_per_s");
  return shake;
}

// Older files have one bearing, which is the nominal camera's where motion is a homography. It is
// moved to the nominal fields, so that no reader takes it for the real camera's.
void place_old_bearing(const Shake& shake, Intruder& intruder) {
  if (!intruder.azimuth_deg || intruder.nominal_azimuth_deg || shake.rotation) return;
  intruder.nominal_azimuth_deg = intruder.azimuth_deg;
  intruder.nominal_elevation_deg = intruder.elevation_deg;
  if (shake.frame_from_reference == Homography::Identity()) return;
  intruder.azimuth_deg.reset();
  intruder.elevation_deg.reset();
}

Frame frame_from(const JsonObject& object) {
  Frame frame;
  frame.frame = object.whole("frame");
  frame.time_s = object.number("time_s");
  frame.damaged = object.truth("damaged");
  const JsonObject camera = object.object("camera");
  frame.camera_position_ned_m = vector(camera, "position_ned_m");
  frame.camera_attitude_yaw_pitch_roll_deg = attitude(camera, "attitude_yaw_pitch_roll_deg");
  const JsonObject motion = object.object("motion");
  frame.motion_state = motion.text("state");
  frame.shake = shake_from(motion);
  for (const JsonObject& intruder : object.objects("intruders"))
    frame.intruders.push_back(intruder_from(intruder));
  for (Intruder& intruder : frame.intruders) place_old_bearing(frame.shake, intruder);
  return frame;
}

LensFacts lens_from(const JsonObject& object) {
  LensFacts lens;
  lens.model = object.text("model");
  lens.width = pixels(object, "width");
  lens.height = pixels(object, "height");
  lens.focal_px = tuple<2>(object, "focal_px");
  lens.principal_point_px = tuple<2>(object, "principal_point_px");
  lens.distortion = object.numbers("distortion");
  return lens;
}

struct Line {
  Frame frame;
  LensFacts lens;
};

Line line_from(std::string_view text, const Where& where) {
  const JsonDocument object(text, where);
  Line line{frame_from(object), lens_from(object.object("lens"))};
  for (const auto& found : {fault(line.frame), fault(line.lens)})
    if (found) throw Error(*found, where);
  return line;
}

}  // namespace

Frame parse_jsonl_line(std::string_view line, const std::filesystem::path& file, int line_number) {
  return line_from(line, {file.string(), line_number, 0}).frame;
}

Truth read_truth(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  Truth truth;
  int number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    Line line =
        line_from(std::string_view(text).substr(at, end - at), {file.string(), ++number, 0});
    if (number == 1) truth.lens = std::move(line.lens);
    truth.frames.push_back(std::move(line.frame));
    at = end + 1;
  }
  if (truth.frames.empty())
    throw Error("is empty; expected a line for each frame", {file.string()});
  return truth;
}

}  // namespace airtruth::annotation
