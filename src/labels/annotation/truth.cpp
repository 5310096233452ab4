// SPDX-License-Identifier: Apache-2.0
#include "labels/annotation/truth.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/json/json_object.h"
#include "labels/annotation/object_class.h"

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

namespace {

bool finite(double value) { return std::isfinite(value); }
bool finite(const Vector3& v) { return v.allFinite(); }
bool finite(const YawPitchRoll& a) {
  return finite(a.yaw_deg) && finite(a.pitch_deg) && finite(a.roll_deg);
}
bool finite(const Box& b) {
  return finite(b.x) && finite(b.y) && finite(b.width) && finite(b.height);
}

template <typename T>
bool finite(const std::optional<T>& value) {
  return !value || finite(*value);
}

bool finite(const EncounterTruth& truth) {
  const encounter::Measures& m = truth.measures;
  return finite(m.horizontal_m) && finite(m.above_m) && finite(m.closing_speed_mps) &&
         finite(m.bearing_deg) && finite(m.bearing_rate_dps) && finite(m.relative_bearing_deg) &&
         finite(m.line_of_sight_rate_dps) && finite(m.tcpa_s) && finite(m.dcpa_m) &&
         finite(m.hmd_m) && finite(m.vmd_m) && finite(m.tau_mod_s) && finite(m.tcoa_s) &&
         std::all_of(truth.volumes.begin(), truth.volumes.end(), [](const VolumeTruth& volume) {
           return finite(volume.to_violation_s);
         });
}

bool all_finite(const Intruder& i) {
  return finite(i.position_ned_m) && finite(i.velocity_ned_mps) &&
         finite(i.attitude_yaw_pitch_roll_deg) && finite(i.position_in_cam_m) &&
         finite(i.range_m) && finite(i.range_rate_mps) && finite(i.azimuth_deg) &&
         finite(i.elevation_deg) && finite(i.nominal_azimuth_deg) &&
         finite(i.nominal_elevation_deg) && (!i.encounter || finite(*i.encounter)) &&
         finite(i.exact_box_px) && finite(i.alpha_sum_px) &&
         (!i.centroid_px || i.centroid_px->allFinite()) && finite(i.hidden_by_own_aircraft) &&
         finite(i.hidden_by_intruder) && finite(i.cut_by_frame);
}

bool is_fraction(double value) { return value >= 0 && value <= 1; }

bool is_below_0(const std::optional<double>& value) { return value && *value < 0; }

std::optional<std::string> fault(const EncounterTruth& truth) {
  const encounter::Measures& m = truth.measures;
  if (m.horizontal_m < 0 || m.hmd_m < 0 || m.vmd_m < 0 || is_below_0(m.dcpa_m) ||
      is_below_0(m.line_of_sight_rate_dps))
    return "has an encounter with a distance or a rate of sight below 0";
  if (is_below_0(m.tcpa_s) || is_below_0(m.tau_mod_s) || is_below_0(m.tcoa_s))
    return "has an encounter with a time below 0";
  if (m.tcpa_s.has_value() != m.dcpa_m.has_value()) return "has half a closest approach";
  constexpr double kRounding = 1 + 1e-9;
  if (m.hmd_m > m.horizontal_m * kRounding || m.vmd_m > std::abs(m.above_m) * kRounding)
    return "has a miss distance above the distance of now";
  for (const VolumeTruth& volume : truth.volumes)
    if (is_below_0(volume.to_violation_s) || (volume.inside && volume.to_violation_s != 0.0))
      return fmt::format("is {} the volume '{}' with another time to its violation",
                         volume.inside ? "inside" : "outside",
                         volume.name);
  return std::nullopt;
}

// What is on the lens has no place in the world; everything else has one unless it is ended.
std::optional<std::string> fault_of_place(const Intruder& i) {
  const bool placed = i.position_ned_m && i.velocity_ned_mps && i.attitude_yaw_pitch_roll_deg &&
                      i.position_in_cam_m && i.range_m;
  const bool any_place = i.position_ned_m || i.velocity_ned_mps || i.attitude_yaw_pitch_roll_deg ||
                         i.position_in_cam_m || i.range_m || i.range_rate_mps || i.azimuth_deg ||
                         i.elevation_deg || i.nominal_azimuth_deg || i.nominal_elevation_deg ||
                         i.encounter;
  if (i.state == State::kEnded && (any_place || i.exact_box_px)) return "is ended and has a place";
  if (is_on_lens(i.object_class)) {
    if (any_place) return fmt::format("is a {} and has a place in the world", i.object_class);
    if (i.state == State::kBehind) return fmt::format("is a {} and behind", i.object_class);
    return std::nullopt;
  }
  if (i.state != State::kEnded && !placed)
    return fmt::format("is {} and lacks its place", name(i.state));
  return std::nullopt;
}

std::optional<std::string> fault(const Intruder& i) {
  if (!all_finite(i)) return "holds a number that is not finite";
  if (!is_object_class(i.object_class))
    return fmt::format(
        "is of the class '{}'; expected aircraft, bird, multirotor, balloon, glint, dirt or insect",
        i.object_class.substr(0, 40));
  if (i.visible_box_px.has_value() != (i.state == State::kVisible))
    return fmt::format(
        "is {} and has {} visible_box_px", name(i.state), i.visible_box_px ? "a" : "no");
  if (const auto found = fault_of_place(i)) return found;
  if (i.azimuth_deg.has_value() != i.elevation_deg.has_value() ||
      i.nominal_azimuth_deg.has_value() != i.nominal_elevation_deg.has_value())
    return "has half a bearing";
  if (i.covered_box_px && i.state != State::kVisible)
    return fmt::format("is {} and has a covered_box_px", name(i.state));
  if (i.covered_box_px && (i.covered_box_px->width <= 0 || i.covered_box_px->height <= 0))
    return "has an empty covered_box_px";
  if (i.visible_box_px && (i.visible_box_px->width <= 0 || i.visible_box_px->height <= 0))
    return "has an empty visible_box_px";
  if (i.exact_box_px && (i.exact_box_px->width < 0 || i.exact_box_px->height < 0))
    return "has an exact_box_px of negative size";
  if (i.visible_area_px < 0 || i.alpha_sum_px < 0 || (i.range_m && *i.range_m < 0))
    return "holds an area or a range below 0";
  if (!is_fraction(i.hidden_by_own_aircraft) || !is_fraction(i.hidden_by_intruder) ||
      !is_fraction(i.cut_by_frame))
    return "holds a fraction outside 0..1";
  return i.encounter ? fault(*i.encounter) : std::nullopt;
}

}  // namespace

std::optional<std::string> fault(const Frame& frame) {
  if (frame.frame < 0) return "frame is below 0";
  if (!finite(frame.time_s) || !finite(frame.camera_position_ned_m) ||
      !finite(frame.camera_attitude_yaw_pitch_roll_deg) ||
      !frame.shake.frame_from_reference.allFinite() ||
      !frame.shake.frame_from_reference_per_s.allFinite() || !finite(frame.shake.rate_radps))
    return "holds a number that is not finite";
  if (frame.shake.rotation && !(std::abs(frame.shake.rotation->norm() - 1) < 1e-6))
    return "has a rotation that is no unit quaternion";
  for (const Intruder& intruder : frame.intruders)
    if (const auto found = fault(intruder))
      return fmt::format("intruder '{}' {}", intruder.id, *found);
  return std::nullopt;
}

std::optional<std::string> fault(const LensFacts& lens) {
  const auto all = [](const auto& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  };
  if (!all(lens.focal_px) || !all(lens.principal_point_px) || !all(lens.distortion))
    return "lens holds a number that is not finite";
  return std::nullopt;
}

namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson json(double value) { return value; }
OrderedJson json(const Vector3& v) { return OrderedJson::array({v.x(), v.y(), v.z()}); }
OrderedJson json(const YawPitchRoll& a) {
  return OrderedJson::array({a.yaw_deg, a.pitch_deg, a.roll_deg});
}
OrderedJson json(const Box& b) { return OrderedJson::array({b.x, b.y, b.width, b.height}); }
OrderedJson json(const PixelBox& b) { return OrderedJson::array({b.x, b.y, b.width, b.height}); }

OrderedJson json(const Homography& h) {
  OrderedJson rows = OrderedJson::array();
  for (int i = 0; i < 3; ++i) rows.push_back(OrderedJson::array({h(i, 0), h(i, 1), h(i, 2)}));
  return rows;
}

template <typename T>
void add(OrderedJson& object, const char* key, const std::optional<T>& value) {
  if (value) object[key] = json(*value);
}

OrderedJson json(const EncounterTruth& truth) {
  const encounter::Measures& m = truth.measures;
  OrderedJson object;
  object["horizontal_m"] = m.horizontal_m;
  object["above_m"] = m.above_m;
  add(object, "closing_speed_mps", m.closing_speed_mps);
  add(object, "bearing_deg", m.bearing_deg);
  add(object, "bearing_rate_dps", m.bearing_rate_dps);
  add(object, "relative_bearing_deg", m.relative_bearing_deg);
  add(object, "line_of_sight_rate_dps", m.line_of_sight_rate_dps);
  add(object, "tcpa_s", m.tcpa_s);
  add(object, "dcpa_m", m.dcpa_m);
  object["hmd_m"] = m.hmd_m;
  object["vmd_m"] = m.vmd_m;
  add(object, "tau_mod_s", m.tau_mod_s);
  add(object, "tcoa_s", m.tcoa_s);
  OrderedJson volumes = OrderedJson::array();
  for (const VolumeTruth& volume : truth.volumes) {
    OrderedJson one = {{"name", volume.name}, {"inside", volume.inside}};
    add(one, "to_violation_s", volume.to_violation_s);
    volumes.push_back(std::move(one));
  }
  object["volumes"] = std::move(volumes);
  return object;
}

OrderedJson json(const Intruder& intruder) {
  OrderedJson object;
  object["id"] = intruder.id;
  object["aircraft"] = intruder.aircraft;
  if (!is_aircraft(intruder.object_class)) object["class"] = intruder.object_class;
  object["state"] = name(intruder.state);
  add(object, "position_ned_m", intruder.position_ned_m);
  add(object, "velocity_ned_mps", intruder.velocity_ned_mps);
  add(object, "attitude_yaw_pitch_roll_deg", intruder.attitude_yaw_pitch_roll_deg);
  add(object, "position_in_cam_m", intruder.position_in_cam_m);
  add(object, "range_m", intruder.range_m);
  add(object, "range_rate_mps", intruder.range_rate_mps);
  add(object, "azimuth_deg", intruder.azimuth_deg);
  add(object, "elevation_deg", intruder.elevation_deg);
  add(object, "nominal_azimuth_deg", intruder.nominal_azimuth_deg);
  add(object, "nominal_elevation_deg", intruder.nominal_elevation_deg);
  if (intruder.encounter) object["encounter"] = json(*intruder.encounter);
  add(object, "exact_box_px", intruder.exact_box_px);
  add(object, "covered_box_px", intruder.covered_box_px);
  add(object, "visible_box_px", intruder.visible_box_px);
  object["visible_area_px"] = intruder.visible_area_px;
  object["alpha_sum_px"] = intruder.alpha_sum_px;
  if (intruder.centroid_px)
    object["centroid_px"] = {intruder.centroid_px->x(), intruder.centroid_px->y()};
  object["hidden_by_own_aircraft"] = intruder.hidden_by_own_aircraft;
  object["hidden_by_intruder"] = intruder.hidden_by_intruder;
  object["cut_by_frame"] = intruder.cut_by_frame;
  return object;
}

OrderedJson json(const LensFacts& lens) {
  return {{"model", lens.model},
          {"width", lens.width},
          {"height", lens.height},
          {"focal_px", lens.focal_px},
          {"principal_point_px", lens.principal_point_px},
          {"distortion", lens.distortion}};
}

}  // namespace

const char* name(State state) {
  switch (state) {
    case State::kVisible:
      return "visible";
    case State::kHidden:
      return "hidden";
    case State::kOutside:
      return "outside";
    case State::kBehind:
      return "behind";
    case State::kEnded:
      return "ended";
  }
  return "";
}

std::string jsonl_line(const Frame& frame, const LensFacts& lens) {
  if (const auto found = fault(frame))
    check(false, "truth of frame " + std::to_string(frame.frame) + ": " + *found);
  if (const auto found = fault(lens)) check(false, *found);
  OrderedJson object;
  object["frame"] = frame.frame;
  object["time_s"] = frame.time_s;
  object["damaged"] = frame.damaged;
  object["lens"] = json(lens);
  object["camera"] = {
      {"position_ned_m", json(frame.camera_position_ned_m)},
      {"attitude_yaw_pitch_roll_deg", json(frame.camera_attitude_yaw_pitch_roll_deg)}};
  object["motion"] = {{"state", frame.motion_state},
                      {"frame_from_reference", json(frame.shake.frame_from_reference)}};
  if (frame.shake.rotation) {
    const Quaternion& q = *frame.shake.rotation;
    object["motion"]["rotation"] = {q.w(), q.x(), q.y(), q.z()};
  }
  if (!frame.shake.rate_radps.isZero(0))
    object["motion"]["rate_radps"] = json(frame.shake.rate_radps);
  if (!frame.shake.frame_from_reference_per_s.isZero(0))
    object["motion"]["frame_from_reference_per_s"] = json(frame.shake.frame_from_reference_per_s);
  OrderedJson intruders = OrderedJson::array();
  for (const Intruder& intruder : frame.intruders) intruders.push_back(json(intruder));
  object["intruders"] = std::move(intruders);
  return object.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

}  // namespace airtruth::annotation
