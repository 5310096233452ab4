// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <pugixml.hpp>

#include "camera/lens/calibration.h"
#include "foundation/base/error.h"
#include "foundation/base/text.h"

namespace airtruth::lens {
namespace {

// Of a side of a picture, in pixels; as in the other calibration files.
constexpr double kLongestSide = 65536;

std::array<double, 9> matrix_of(double fx, double fy, double cx, double cy) {
  // From pixels whose first has its centre at 0.5 to those whose first has it at 0.
  return {fx, 0, cx - 0.5, 0, fy, cy - 0.5, 0, 0, 1};
}

int side_in(double value, const Where& where) {
  if (!(value >= 1 && value <= kLongestSide) || value != std::floor(value))
    throw Error("has a side of " + std::to_string(value) + "; expected whole pixels", where);
  return static_cast<int>(value);
}

// A model of COLMAP: how many parameters it has, how many of them are focal lengths, and where its
// distortion goes among OpenCV's coefficients (k1 k2 p1 p2 k3 k4 k5 k6) or a fisheye's.
struct ColmapModel {
  std::size_t focal_lengths = 1;
  std::vector<std::size_t> distortion;
  bool is_fisheye = false;
};

const std::map<std::string, ColmapModel>& colmap_models() {
  static const std::map<std::string, ColmapModel> models = {
      {"SIMPLE_PINHOLE", {1, {}}},
      {"PINHOLE", {2, {}}},
      {"SIMPLE_RADIAL", {1, {0}}},
      {"RADIAL", {1, {0, 1}}},
      {"OPENCV", {2, {0, 1, 2, 3}}},
      {"FULL_OPENCV", {2, {0, 1, 2, 3, 4, 5, 6, 7}}},
      {"SIMPLE_RADIAL_FISHEYE", {1, {0}, true}},
      {"RADIAL_FISHEYE", {1, {0, 1}, true}},
      {"OPENCV_FISHEYE", {2, {0, 1, 2, 3}, true}}};
  return models;
}

Calibration colmap_camera(const std::string& line, const Where& where) {
  std::istringstream words(line);
  std::string id, name;
  words >> id >> name;
  const auto found = colmap_models().find(name);
  if (found == colmap_models().end())
    throw Error(
        "has the model '" + name.substr(0, 40) +
            "', which cannot be honoured; expected a pinhole, radial, OpenCV or fisheye one",
        where);
  std::vector<double> numbers;
  for (std::string word; words >> word;) numbers.push_back(finite_number(word, where));
  const ColmapModel& model = found->second;
  const std::size_t expected = 2 + model.focal_lengths + 2 + model.distortion.size();
  if (numbers.size() != expected)
    throw Error(name + " has " + std::to_string(numbers.size()) + " numbers; expected " +
                    std::to_string(expected) + " (width, height and the parameters)",
                where);
  Calibration c;
  c.fisheye = model.is_fisheye;
  c.size = {side_in(numbers[0], where), side_in(numbers[1], where)};
  const std::size_t centre = 2 + model.focal_lengths;
  c.camera_matrix =
      matrix_of(numbers[2], numbers[centre - 1], numbers[centre], numbers[centre + 1]);
  c.distortion.assign(model.is_fisheye || model.distortion.size() <= 4 ? 4 : 8, 0.0);
  for (std::size_t i = 0; i < model.distortion.size(); ++i)
    c.distortion[model.distortion[i]] = numbers[centre + 2 + i];
  return c;
}

}  // namespace

Calibration parse_colmap_cameras(std::string_view text, const std::filesystem::path& name) {
  std::optional<Calibration> camera;
  int number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line(airtruth::trimmed(text.substr(at, end - at)));
    const Where where{name.string(), ++number};
    at = end + 1;
    if (line.empty() || line.front() == '#') continue;
    if (camera) throw Error("is a second camera; expected a file with one", where);
    camera = colmap_camera(line, where);
  }
  if (!camera) throw Error("holds no camera; expected COLMAP's cameras.txt", {name.string()});
  return *camera;
}

Calibration parse_agisoft_calibration(std::string_view text, const std::filesystem::path& name) {
  pugi::xml_document document;
  const auto parsed = document.load_buffer(text.data(), text.size());
  if (!parsed)
    throw Error(std::string("is not XML: ") + parsed.description(),
                {name.string(), line_of(text, parsed.offset)});
  const pugi::xml_node top = document.child("calibration");
  const auto where = [&](const pugi::xml_node& node) {
    return Where{name.string(), line_of(text, node.offset_debug())};
  };
  const std::string projection = top.child_value("projection");
  if (projection != "frame" && projection != "fisheye")
    throw Error("has the projection '" + projection.substr(0, 40) + "'; expected frame or fisheye",
                where(top));
  std::map<std::string, double> values;
  for (const pugi::xml_node& node : top.children()) {
    const std::string key = node.name();
    if (key == "projection" || key == "date" || key.empty()) continue;
    const double value =
        finite_number(std::string(airtruth::trimmed(node.child_value())), where(node));
    if (!values.emplace(key, value).second)
      throw Error("<" + key.substr(0, 40) + "> is there twice; expected one", where(node));
  }
  Calibration c;
  c.fisheye = projection == "fisheye";
  c.size = {side_in(values["width"], where(top)), side_in(values["height"], where(top))};
  const double f = values["f"];
  c.camera_matrix = matrix_of(
      f + values["b1"], f, c.size.width / 2.0 + values["cx"], c.size.height / 2.0 + values["cy"]);
  c.camera_matrix[1] = values["b2"];
  if (c.fisheye) {
    c.distortion = {values["k1"], values["k2"], values["k3"], values["k4"]};
  } else {
    c.distortion = {values["k1"], values["k2"], values["p2"], values["p1"], values["k3"]};
  }
  const std::vector<const char*> absent = c.fisheye ? std::vector{"p1", "p2"} : std::vector{"k4"};
  for (const char* key : absent)
    if (values[key] != 0)
      throw Error(std::string(key) + " is not 0; no lens model here has it", where(top));
  for (const std::string& key :
       words_in("projection date width height f cx cy b1 b2 k1 k2 k3 k4 p1 p2"))
    values.erase(key);
  for (const auto& [key, value] : values)
    if (value != 0)
      throw Error("<" + key.substr(0, 40) + "> is not 0; no lens model here has it", where(top));
  return c;
}

}  // namespace airtruth::lens
