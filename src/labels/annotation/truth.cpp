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
#include "foundation/json/or_null.h"
#include "labels/annotation/object_class.h"
#include "labels/annotation/truth_fields.h"

namespace airtruth::annotation {
namespace {

// Largest position or size in pixels, far below the values whose sums overflow an int.
constexpr std::int64_t kLargestTruthPixel = 1 << 29;

int pixels(const JsonObject& object, const char* key) {
  return static_cast<int>(object.whole(key, -kLargestTruthPixel, kLargestTruthPixel));
}

std::array<double, 9> homography(const JsonObject& object, const char* key) {
  std::array<double, 9> result{};
  std::ranges::copy(object.matrix(key, 3, 3), result.begin());
  return result;
}

// Takes the values of members from an object: visit of truth_fields.h. An optional member that is
// empty is null; hidden_by_occluder is missing instead.
struct Reading {
  const JsonObject& object;

  void operator()(const char* key, double& value) const { value = object.number(key); }
  void operator()(const char* key, std::int64_t& value) const { value = object.whole(key); }
  template <std::size_t n>
  void operator()(const char* key, std::array<double, n>& value) const {
    std::ranges::copy(object.numbers(key, n), value.begin());
  }
  void operator()(const char* key, Box& value) const {
    const auto v = object.numbers(key, 4);
    value = {v[0], v[1], v[2], v[3]};
  }
  void operator()(const char* key, PixelBox& value) const {
    const auto v = object.wholes(key, 4, -kLargestTruthPixel, kLargestTruthPixel);
    const auto at = [&](std::size_t i) { return static_cast<int>(v[i]); };
    value = {at(0), at(1), at(2), at(3)};
  }
  void operator()(const char* key, State& value) const {
    const auto state = enum_named<State>(object.text(key));
    if (!state) object.fail(key, "visible, hidden, outside, behind or ended");
    value = *state;
  }
  void operator()(const char* key, EncounterTruth& value) const {
    const JsonObject encounter = object.object(key);
    each_measure(Reading{encounter}, value);
    for (const JsonObject& volume : encounter.objects("volumes"))
      value.volumes.push_back(
          {volume.text("name"), volume.truth("inside"), volume.maybe_number("to_violation_s")});
  }
  template <typename T>
  void operator()(const char* key, std::optional<T>& value) const {
    const bool may_be_missing = key == std::string_view("hidden_by_occluder");
    if (may_be_missing ? object.has(key) : !object.value(key).is_null())
      (*this)(key, value.emplace());
  }
};

Intruder intruder_from(const JsonObject& object) {
  Intruder intruder;
  intruder.id = object.text("id");
  intruder.aircraft = object.text("aircraft");
  intruder.object_class = object.maybe_text("class").value_or(intruder.object_class);
  each_field(Reading{object}, intruder);
  return intruder;
}

Frame frame_from(const JsonObject& object) {
  Frame frame;
  frame.frame = object.whole("frame");
  frame.time_s = object.number("time_s");
  frame.damaged = object.truth("damaged");
  const JsonObject camera = object.object("camera");
  Reading{camera}("position_ned_m", frame.camera_position_ned_m);
  Reading{camera}("attitude_yaw_pitch_roll_deg", frame.camera_attitude_yaw_pitch_roll_deg);
  const JsonObject motion = object.object("motion");
  frame.motion_state = motion.text("state");
  frame.frame_from_reference = homography(motion, "frame_from_reference");
  Reading{motion}("rotation", frame.rotation);
  if (motion.has("rate_radps")) Reading{motion}("rate_radps", frame.rate_radps);
  if (motion.has("frame_from_reference_per_s"))
    frame.frame_from_reference_per_s = homography(motion, "frame_from_reference_per_s");
  for (const JsonObject& intruder : object.objects("intruders"))
    frame.intruders.push_back(intruder_from(intruder));
  return frame;
}

lens::Facts lens_from(const JsonObject& object) {
  lens::Facts lens;
  lens.model = object.text("model");
  if (!enum_named<lens::ModelKind>(lens.model))
    object.fail("model", "pinhole, brown_conrady or fisheye");
  lens.width = pixels(object, "width");
  lens.height = pixels(object, "height");
  Reading{object}("focal_px", lens.focal_px);
  Reading{object}("principal_point_px", lens.principal_point_px);
  lens.distortion = object.numbers("distortion");
  lens.max_angle_rad = object.maybe_number("max_angle_rad").value_or(kPi);
  return lens;
}

struct Line {
  Frame frame;
  lens::Facts lens;
};

Line line_from(std::string_view text, const Where& where) {
  const JsonDocument object(text, where);
  Line line{frame_from(object), lens_from(object.object("lens"))};
  if (const auto found = fault(line.frame)) throw Error(*found, where);
  return line;
}

using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

std::array<double, 9> row_by_row(const Homography& h) {
  std::array<double, 9> numbers{};
  Eigen::Map<Rows>(numbers.data()) = h;
  return numbers;
}

}  // namespace

Shake shake_of(const Frame& frame) {
  Shake shake;
  shake.frame_from_reference = Eigen::Map<const Rows>(frame.frame_from_reference.data());
  shake.frame_from_reference_per_s =
      Eigen::Map<const Rows>(frame.frame_from_reference_per_s.data());
  if (const auto& q = frame.rotation)
    shake.rotation = Quaternion((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
  shake.rate_radps = vector_of(frame.rate_radps);
  return shake;
}

void take_shake(const Shake& shake, Frame& frame) {
  frame.frame_from_reference = row_by_row(shake.frame_from_reference);
  frame.frame_from_reference_per_s = row_by_row(shake.frame_from_reference_per_s);
  frame.rotation.reset();
  if (const auto& q = shake.rotation) frame.rotation = {q->w(), q->x(), q->y(), q->z()};
  frame.rate_radps = numbers_of(shake.rate_radps);
}

bool is_in_view(const Frame& frame, const Intruder& intruder, const lens::Lens& lens) {
  if (!intruder.position_in_cam_m) return false;
  const auto nominal = lens.pixel_from_cam(vector_of(*intruder.position_in_cam_m));
  if (!nominal) return false;
  const Vector3 h = shake_of(frame).frame_from_reference * Vector3(nominal->x(), nominal->y(), 1);
  if (!(h.z() > 0)) return false;
  return lens.size().holds(h.head<2>() / h.z());
}

bool lacks_box(const Frame& frame, const Intruder& intruder, const lens::Lens& lens) {
  return !intruder.visible_box_px && intruder.state != State::kHidden &&
         is_in_view(frame, intruder, lens);
}

Frame parse_jsonl_line(std::string_view line, const std::filesystem::path& file, int line_number) {
  return line_from(line, {file.string(), line_number, 0}).frame;
}

Truth read_truth(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  Truth truth;
  int number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const Where where{file.string(), ++number, 0};
    Line line = line_from(std::string_view(text).substr(at, end - at), where);
    if (line.frame.frame != number - 1)
      throw Error(fmt::format("frame is {}; expected {}: the lines are the video's frames in order",
                              line.frame.frame,
                              number - 1),
                  where);
    if (number == 1) truth.lens = std::move(line.lens);
    truth.frames.push_back(std::move(line.frame));
    at = end + 1;
  }
  if (truth.frames.empty())
    throw Error("is empty; expected a line for each frame", {file.string()});
  return truth;
}

namespace {

bool is_fraction(double value) { return value >= 0 && value <= 1; }

bool is_below_0(const std::optional<double>& value) { return value && *value < 0; }

std::optional<std::string> fault(const EncounterTruth& m) {
  if (m.horizontal_m < 0 || m.hmd_m < 0 || m.vmd_m < 0 || is_below_0(m.dcpa_m) ||
      is_below_0(m.line_of_sight_rate_dps))
    return "has an encounter with a distance or a rate of sight below 0";
  if (is_below_0(m.tcpa_s) || is_below_0(m.tau_mod_s) || is_below_0(m.tcoa_s))
    return "has an encounter with a time below 0";
  if (m.tcpa_s.has_value() != m.dcpa_m.has_value()) return "has half a closest approach";
  // A factor above the rounding of numbers in a file.
  constexpr double kRounding = 1 + 1e-9;
  if (m.hmd_m > m.horizontal_m * kRounding || m.vmd_m > std::abs(m.above_m) * kRounding)
    return "has a miss distance above the distance of now";
  for (const VolumeTruth& volume : m.volumes)
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
    return fmt::format("is {} and lacks its place", enum_name(i.state));
  return std::nullopt;
}

std::optional<std::string> fault(const Intruder& i) {
  if (!is_object_class(i.object_class))
    return fmt::format(
        "is of the class '{}'; expected aircraft, bird, multirotor, balloon, glint, dirt or insect",
        i.object_class.substr(0, 40));
  if (i.visible_box_px.has_value() != (i.state == State::kVisible))
    return fmt::format(
        "is {} and has {} visible_box_px", enum_name(i.state), i.visible_box_px ? "a" : "no");
  if (const auto found = fault_of_place(i)) return found;
  if (i.azimuth_deg.has_value() != i.elevation_deg.has_value() ||
      i.nominal_azimuth_deg.has_value() != i.nominal_elevation_deg.has_value())
    return "has half a bearing";
  if (i.covered_box_px && i.state != State::kVisible)
    return fmt::format("is {} and has a covered_box_px", enum_name(i.state));
  if (i.covered_box_px && (i.covered_box_px->width <= 0 || i.covered_box_px->height <= 0))
    return "has an empty covered_box_px";
  if (i.covered_area_px && !(i.covered_box_px && *i.covered_area_px > 0))
    return "has a covered_area_px and no covered pixel";
  if (i.visible_box_px && (i.visible_box_px->width <= 0 || i.visible_box_px->height <= 0))
    return "has an empty visible_box_px";
  if (i.exact_box_px && (i.exact_box_px->width < 0 || i.exact_box_px->height < 0))
    return "has an exact_box_px of negative size";
  if (i.contrast_to_noise && (i.state != State::kVisible || *i.contrast_to_noise < 0))
    return "has a contrast_to_noise below 0, or of nothing visible";
  if (i.visible_area_px < 0 || i.alpha_sum_px < 0 || (i.range_m && *i.range_m < 0))
    return "holds an area or a range below 0";
  if (!is_fraction(i.hidden_by_own_aircraft) || !is_fraction(i.hidden_by_occluder.value_or(0)) ||
      !is_fraction(i.hidden_by_intruder) || !is_fraction(i.cut_by_frame))
    return "holds a fraction outside 0..1";
  return i.encounter ? fault(*i.encounter) : std::nullopt;
}

}  // namespace

std::optional<std::string> fault(const Frame& frame) {
  if (frame.frame < 0) return "frame is below 0";
  const auto& q = frame.rotation;
  if (q && !(std::abs(Eigen::Map<const Eigen::Vector4d>(q->data()).norm() - 1) < 1e-6))
    return "has a rotation that is no unit quaternion";
  for (const Intruder& intruder : frame.intruders)
    if (const auto found = fault(intruder))
      return fmt::format("intruder '{}' {}", intruder.id, *found);
  return std::nullopt;
}

namespace {

using OrderedJson = nlohmann::ordered_json;

// Of a number, or of several in an array.
template <typename T>
OrderedJson json(const T& value) {
  return value;
}
OrderedJson json(State state) { return enum_name(state); }
OrderedJson json(const Box& b) { return OrderedJson::array({b.x, b.y, b.width, b.height}); }
OrderedJson json(const PixelBox& b) { return OrderedJson::array({b.x, b.y, b.width, b.height}); }

OrderedJson rows_of(const std::array<double, 9>& h) {
  return {{h[0], h[1], h[2]}, {h[3], h[4], h[5]}, {h[6], h[7], h[8]}};
}

OrderedJson json(const EncounterTruth& truth);

// Adds the values of members to an object: visit of truth_fields.h. An optional member that is
// empty is null.
struct Writing {
  OrderedJson& object;

  template <typename T>
  void operator()(const char* key, const T& value) const {
    object[key] = json(value);
  }
  template <typename T>
  void operator()(const char* key, const std::optional<T>& value) const {
    object[key] = value ? json(*value) : OrderedJson();
  }
};

OrderedJson json(const EncounterTruth& truth) {
  OrderedJson object;
  each_measure(Writing{object}, truth);
  OrderedJson& volumes = object["volumes"] = OrderedJson::array();
  for (const VolumeTruth& volume : truth.volumes)
    volumes.push_back({{"name", volume.name},
                       {"inside", volume.inside},
                       {"to_violation_s", or_null(volume.to_violation_s)}});
  return object;
}

OrderedJson json(const Intruder& intruder) {
  OrderedJson object = {{"id", intruder.id}, {"aircraft", intruder.aircraft}};
  if (!is_aircraft(intruder.object_class)) object["class"] = intruder.object_class;
  each_field(Writing{object}, intruder);
  if (!intruder.hidden_by_occluder) object.erase("hidden_by_occluder");
  return object;
}

OrderedJson json(const lens::Facts& lens) {
  OrderedJson object = {{"model", lens.model},
                        {"width", lens.width},
                        {"height", lens.height},
                        {"focal_px", lens.focal_px},
                        {"principal_point_px", lens.principal_point_px},
                        {"distortion", lens.distortion}};
  if (lens.max_angle_rad < kPi) object["max_angle_rad"] = lens.max_angle_rad;
  return object;
}

bool is_finite(const OrderedJson& json) {
  if (json.is_structured()) return std::all_of(json.begin(), json.end(), is_finite);
  return !json.is_number_float() || std::isfinite(json.get<double>());
}

}  // namespace

std::string jsonl_line(const Frame& frame, const lens::Facts& lens) {
  const std::string where = "truth of frame " + std::to_string(frame.frame) + ": ";
  if (const auto found = fault(frame)) check(false, where + *found);
  OrderedJson object;
  object["frame"] = frame.frame;
  object["time_s"] = frame.time_s;
  object["damaged"] = frame.damaged;
  object["lens"] = json(lens);
  object["camera"] = {
      {"position_ned_m", json(frame.camera_position_ned_m)},
      {"attitude_yaw_pitch_roll_deg", json(frame.camera_attitude_yaw_pitch_roll_deg)}};
  object["motion"] = {{"state", frame.motion_state},
                      {"frame_from_reference", rows_of(frame.frame_from_reference)}};
  Writing{object["motion"]}("rotation", frame.rotation);
  if (frame.rate_radps != std::array<double, 3>{})
    object["motion"]["rate_radps"] = json(frame.rate_radps);
  if (frame.frame_from_reference_per_s != std::array<double, 9>{})
    object["motion"]["frame_from_reference_per_s"] = rows_of(frame.frame_from_reference_per_s);
  OrderedJson intruders = OrderedJson::array();
  for (const Intruder& intruder : frame.intruders) intruders.push_back(json(intruder));
  object["intruders"] = std::move(intruders);
  check(is_finite(object), where + "holds a number that is not finite");
  return object.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

}  // namespace airtruth::annotation
