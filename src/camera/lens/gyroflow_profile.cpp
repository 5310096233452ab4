// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <nlohmann/json.hpp>

#include "camera/lens/calibration.h"
#include "foundation/base/error.h"

namespace airtruth::lens {
namespace {

using nlohmann::json;

// The line of the first mention of a key, for messages; 0 where it has none.
int line_of(std::string_view text, const std::string& key) {
  const std::size_t at = text.find('"' + key + '"');
  if (at == std::string_view::npos) return 0;
  return 1 + static_cast<int>(
                 std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

struct Profile {
  const json& object;
  std::string_view text;
  std::string file;

  [[noreturn]] void fail(const std::string& key, const std::string& message) const {
    throw Error(key + " " + message, {file, line_of(text, key)});
  }
  const json& at(const json& from, const std::string& key) const {
    if (!from.is_object() || !from.contains(key))
      throw Error("has no '" + key + "'; expected a Gyroflow lens profile", {file});
    return from.at(key);
  }
  double number(const json& value, const std::string& key) const {
    if (!value.is_number()) fail(key, "holds something that is no number");
    return value.get<double>();
  }
  bool absent_or(const std::string& key, const std::function<bool(const json&)>& good) const {
    return !object.contains(key) || object.at(key).is_null() || good(object.at(key));
  }
};

// What changes where a ray lands and no lens model here can follow.
void refuse_what_cannot_be_honoured(const Profile& profile) {
  const auto one = [](const json& v) { return v.is_number() && v.get<double>() == 1.0; };
  const auto empty_text = [](const json& v) {
    return v.is_string() && v.get<std::string>().empty();
  };
  for (const char* key : {"input_horizontal_stretch", "input_vertical_stretch"})
    if (!profile.absent_or(key, one))
      profile.fail(key, "is not 1; an anamorphic stretch cannot be honoured");
  if (!profile.absent_or("distortion_model", [&](const json& v) {
        return empty_text(v) || (v.is_string() && v.get<std::string>() == "opencv_fisheye");
      }))
    profile.fail("distortion_model",
                 "is not opencv_fisheye; no other model of Gyroflow's can be honoured");
  for (const char* key : {"digital_lens", "digital_lens_params"})
    if (!profile.absent_or(key, empty_text))
      profile.fail(key, "is set; a digital lens cannot be honoured");
  if (!profile.absent_or("interpolations", [](const json& v) { return v.empty(); }))
    profile.fail("interpolations", "is set; a lens that changes with its zoom cannot be honoured");
  if (!profile.absent_or("use_opencv_standard",
                         [](const json& v) { return v.is_boolean() && !v.get<bool>(); }))
    profile.fail("use_opencv_standard", "is set; no other model than the fisheye can be honoured");
  if (!profile.absent_or("crop", one)) profile.fail("crop", "is set; a crop cannot be honoured");
}

// Gyroflow's limit is a radius on the plane at distance 1, tan(angle); 0 says that there is none.
double stated_max_angle(const Profile& profile, const json& fisheye) {
  const char* key = "radial_distortion_limit";
  if (!fisheye.contains(key) || fisheye.at(key).is_null()) return kPi;
  const double limit = profile.number(fisheye.at(key), key);
  if (limit < 0) profile.fail(key, "is below 0; expected the tangent of an angle");
  return limit == 0 ? kPi : std::atan(limit);
}

// Brand and model, without what would break a message's line.
std::string camera_of(const json& object) {
  std::string camera;
  for (const char* key : {"camera_brand", "camera_model"}) {
    const auto at = object.find(key);
    if (at == object.end() || !at->is_string() || at->get<std::string>().empty()) continue;
    camera += (camera.empty() ? "" : " ") + at->get<std::string>();
  }
  std::erase_if(camera, [](unsigned char c) { return c < 0x20 || c == 0x7f; });
  return camera;
}

}  // namespace

Calibration parse_gyroflow_profile(std::string_view text, const std::filesystem::path& name) {
  json object;
  try {
    object = json::parse(text);
  } catch (const json::parse_error& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(text.size(), error.byte));
    throw Error("is not JSON",
                {name.string(), 1 + static_cast<int>(std::count(text.begin(), end, '\n'))});
  } catch (const json::exception&) {  // a number beyond double
    throw Error("holds a number that is too large; expected a Gyroflow lens profile",
                {name.string()});
  }
  const Profile profile{object, text, name.string()};
  refuse_what_cannot_be_honoured(profile);
  const json& fisheye = profile.at(object, "fisheye_params");
  const json& matrix = profile.at(fisheye, "camera_matrix");
  if (!matrix.is_array() || matrix.size() != 3)
    profile.fail("camera_matrix", "is not 3 rows of 3 numbers");
  Calibration c;
  c.fisheye = true;
  for (std::size_t row = 0; row < 3; ++row) {
    if (!matrix[row].is_array() || matrix[row].size() != 3)
      profile.fail("camera_matrix", "is not 3 rows of 3 numbers");
    for (std::size_t column = 0; column < 3; ++column)
      c.camera_matrix[3 * row + column] = profile.number(matrix[row][column], "camera_matrix");
  }
  const json& coefficients = profile.at(fisheye, "distortion_coeffs");
  if (!coefficients.is_array() || coefficients.size() != 4)
    profile.fail("distortion_coeffs", "is not a list of four numbers");
  for (const json& value : coefficients)
    c.distortion.push_back(profile.number(value, "distortion_coeffs"));
  c.max_angle_rad = stated_max_angle(profile, fisheye);
  const json& size = profile.at(object, "calib_dimension");
  const double width = profile.number(profile.at(size, "w"), "calib_dimension");
  const double height = profile.number(profile.at(size, "h"), "calib_dimension");
  if (!(width >= 1 && width <= 65536 && height >= 1 && height <= 65536))
    profile.fail("calib_dimension", "is not a size in pixels");
  c.size = {static_cast<int>(width), static_cast<int>(height)};
  c.camera = camera_of(object);
  return c;
}

}  // namespace airtruth::lens
