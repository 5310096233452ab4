// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "truth/annotation/truth.h"
#include "truth/annotation/truth_rules.h"

namespace airtruth::annotation {
namespace {

using Json = nlohmann::json;

// The JSON object of one line, and its name in error messages.
class Object {
 public:
  Object(const Json& json, std::string name, const Where& where)
      : json_(&json), name_(std::move(name)), where_(where) {
    if (!json.is_object()) fail(name_, "an object");
  }

  bool has(const char* key) const { return json_->contains(key); }
  Object object(const char* key) const { return {at(key), key, where_}; }

  std::vector<Object> objects(const char* key) const {
    const Json& list = at(key);
    if (!list.is_array()) fail(key, "an array");
    std::vector<Object> result;
    for (const Json& element : list) result.emplace_back(element, key, where_);
    return result;
  }

  std::string text(const char* key) const {
    if (!at(key).is_string()) fail(key, "a string");
    return at(key).get<std::string>();
  }
  bool truth(const char* key) const {
    if (!at(key).is_boolean()) fail(key, "true or false");
    return at(key).get<bool>();
  }
  double number(const char* key) const { return number(at(key), key); }
  std::int64_t whole(const char* key) const { return whole(at(key), key); }

  std::vector<double> numbers(const char* key) const {
    if (!at(key).is_array()) fail(key, "an array of numbers");
    std::vector<double> result;
    for (const Json& element : at(key)) result.push_back(number(element, key));
    return result;
  }

  template <std::size_t n>
  std::array<double, n> tuple(const char* key) const {
    return tuple<n>(at(key), key);
  }

  Homography matrix(const char* key) const {
    const Json& rows = at(key);
    if (!rows.is_array() || rows.size() != 3) fail(key, "3 rows of 3 numbers");
    Homography h;
    for (int i = 0; i < 3; ++i) {
      const auto row = tuple<3>(rows[static_cast<std::size_t>(i)], key);
      h.row(i) << row[0], row[1], row[2];
    }
    return h;
  }

  std::optional<PixelBox> pixel_box(const char* key) const {
    if (!has(key)) return std::nullopt;
    if (!at(key).is_array() || at(key).size() != 4) fail(key, "4 whole numbers");
    std::array<int, 4> v{};
    for (std::size_t i = 0; i < 4; ++i) v[i] = small(at(key)[i], key);
    return PixelBox{v[0], v[1], v[2], v[3]};
  }
  int small(const char* key) const { return small(at(key), key); }

  std::optional<double> maybe_number(const char* key) const {
    return has(key) ? std::optional(number(key)) : std::nullopt;
  }
  std::optional<Vector3> maybe_vector(const char* key) const {
    return has(key) ? std::optional(vector(key)) : std::nullopt;
  }
  std::optional<YawPitchRoll> maybe_attitude(const char* key) const {
    return has(key) ? std::optional(attitude(key)) : std::nullopt;
  }
  Vector3 vector(const char* key) const {
    const auto v = tuple<3>(key);
    return {v[0], v[1], v[2]};
  }
  YawPitchRoll attitude(const char* key) const {
    const auto v = tuple<3>(key);
    return {v[0], v[1], v[2]};
  }

  [[noreturn]] void fail(const std::string& key, std::string_view expected) const {
    throw Error(fmt::format("{} is not what it should be; expected {}", key, expected), where_);
  }

 private:
  const Json& at(const char* key) const {
    const auto found = json_->find(key);
    if (found == json_->end()) throw Error(fmt::format("{} has no '{}'", name_, key), where_);
    return *found;
  }
  double number(const Json& value, const char* key) const {
    if (!value.is_number()) fail(key, "a number");
    return value.get<double>();
  }
  std::int64_t whole(const Json& value, const char* key) const {
    const bool too_large =
        value.is_number_unsigned() && value.get<std::uint64_t>() > std::uint64_t{INT64_MAX};
    if (!value.is_number_integer() || too_large) fail(key, "a whole number");
    return value.get<std::int64_t>();
  }
  // A size or position in pixels, far below the values where sums overflow.
  int small(const Json& value, const char* key) const {
    const std::int64_t number = whole(value, key);
    if (number < -(1 << 29) || number > (1 << 29)) fail(key, "a number of pixels");
    return static_cast<int>(number);
  }
  template <std::size_t n>
  std::array<double, n> tuple(const Json& value, const char* key) const {
    if (!value.is_array() || value.size() != n) fail(key, fmt::format("{} numbers", n));
    std::array<double, n> result{};
    for (std::size_t i = 0; i < n; ++i) result[i] = number(value[i], key);
    return result;
  }

  const Json* json_;
  std::string name_;
  Where where_;
};

State state_from(const Object& object) {
  const std::string word = object.text("state");
  for (const State state :
       {State::kVisible, State::kHidden, State::kOutside, State::kBehind, State::kEnded})
    if (word == name(state)) return state;
  object.fail("state", "visible, hidden, outside, behind or ended");
}

Intruder intruder_from(const Object& object) {
  Intruder intruder;
  intruder.id = object.text("id");
  intruder.aircraft = object.text("aircraft");
  intruder.state = state_from(object);
  intruder.position_ned_m = object.maybe_vector("position_ned_m");
  intruder.velocity_ned_mps = object.maybe_vector("velocity_ned_mps");
  intruder.attitude_yaw_pitch_roll_deg = object.maybe_attitude("attitude_yaw_pitch_roll_deg");
  intruder.position_in_cam_m = object.maybe_vector("position_in_cam_m");
  intruder.range_m = object.maybe_number("range_m");
  intruder.range_rate_mps = object.maybe_number("range_rate_mps");
  intruder.azimuth_deg = object.maybe_number("azimuth_deg");
  intruder.elevation_deg = object.maybe_number("elevation_deg");
  intruder.nominal_azimuth_deg = object.maybe_number("nominal_azimuth_deg");
  intruder.nominal_elevation_deg = object.maybe_number("nominal_elevation_deg");
  if (object.has("exact_box_px")) {
    const auto box = object.tuple<4>("exact_box_px");
    intruder.exact_box_px = Box{box[0], box[1], box[2], box[3]};
  }
  intruder.covered_box_px = object.pixel_box("covered_box_px");
  intruder.visible_box_px = object.pixel_box("visible_box_px");
  intruder.visible_area_px = object.whole("visible_area_px");
  intruder.alpha_sum_px = object.number("alpha_sum_px");
  if (object.has("centroid_px")) {
    const auto at = object.tuple<2>("centroid_px");
    intruder.centroid_px = Pixel(at[0], at[1]);
  }
  intruder.hidden_by_own_aircraft = object.number("hidden_by_own_aircraft");
  intruder.hidden_by_intruder = object.number("hidden_by_intruder");
  intruder.cut_by_frame = object.number("cut_by_frame");
  return intruder;
}

Shake shake_from(const Object& motion) {
  Shake shake;
  shake.frame_from_reference = motion.matrix("frame_from_reference");
  if (motion.has("rotation")) {
    const auto q = motion.tuple<4>("rotation");
    shake.rotation = Quaternion(q[0], q[1], q[2], q[3]);
  }
  if (motion.has("rate_radps")) shake.rate_radps = motion.vector("rate_radps");
  if (motion.has("frame_from_reference_per_s"))
    shake.frame_from_reference_per_s = motion.matrix("frame_from_reference_per_s");
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

Frame frame_from(const Object& object) {
  Frame frame;
  frame.frame = object.whole("frame");
  frame.time_s = object.number("time_s");
  frame.damaged = object.truth("damaged");
  const Object camera = object.object("camera");
  frame.camera_position_ned_m = camera.vector("position_ned_m");
  frame.camera_attitude_yaw_pitch_roll_deg = camera.attitude("attitude_yaw_pitch_roll_deg");
  const Object motion = object.object("motion");
  frame.motion_state = motion.text("state");
  frame.shake = shake_from(motion);
  for (const Object& intruder : object.objects("intruders"))
    frame.intruders.push_back(intruder_from(intruder));
  for (Intruder& intruder : frame.intruders) place_old_bearing(frame.shake, intruder);
  return frame;
}

LensFacts lens_from(const Object& object) {
  LensFacts lens;
  lens.model = object.text("model");
  lens.width = object.small("width");
  lens.height = object.small("height");
  lens.focal_px = object.tuple<2>("focal_px");
  lens.principal_point_px = object.tuple<2>("principal_point_px");
  lens.distortion = object.numbers("distortion");
  return lens;
}

struct Line {
  Frame frame;
  LensFacts lens;
};

Line line_from(std::string_view text, const Where& where) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::exception&) {
    throw Error("is not JSON; expected an object, as `airtruth render` writes them", where);
  }
  const Object object(json, "the line", where);
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
