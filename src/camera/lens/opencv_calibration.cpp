// SPDX-License-Identifier: Apache-2.0
// OpenCV's FileStorage, as its calibration samples, kalibr-like tools and ROS write it: XML through
// pugixml, and the small part of YAML that FileStorage and camera_info files use (scalars, flow
// lists, nested maps by indentation).
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>
#include <string>

#include <pugixml.hpp>

#include "camera/lens/calibration.h"
#include "foundation/base/error.h"

namespace airtruth::lens {
namespace {

struct Value {
  std::string text;
  int line = 0;
};
using Values = std::map<std::string, Value>;  // "camera_matrix.data" -> "[ 1, 0, ... ]"

int line_at(std::string_view text, std::ptrdiff_t offset) {
  const auto end = text.begin() +
                   std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(text.size()));
  return 1 + static_cast<int>(std::count(text.begin(), end, '\n'));
}

Values values_of_xml(std::string_view text, const std::string& file) {
  pugi::xml_document document;
  const auto parsed = document.load_buffer(text.data(), text.size());
  if (!parsed)
    throw Error(std::string("is not XML: ") + parsed.description(),
                {file, line_at(text, parsed.offset)});
  Values values;
  for (const pugi::xml_node node : document.child("opencv_storage")) {
    const int line = line_at(text, node.offset_debug());
    if (node.child("data")) {
      values[std::string(node.name()) + ".data"] = {node.child("data").text().get(), line};
    } else {
      values[node.name()] = {node.text().get(), line};
    }
  }
  if (values.empty())
    throw Error("holds no <opencv_storage> with values; expected an OpenCV calibration", {file});
  return values;
}

std::string trimmed(std::string text) {
  const auto space = [](unsigned char c) { return std::isspace(c) != 0; };
  text.erase(text.begin(), std::find_if_not(text.begin(), text.end(), space));
  text.erase(std::find_if_not(text.rbegin(), text.rend(), space).base(), text.end());
  return text;
}

Values values_of_yaml(std::string_view text) {
  Values values;
  std::istringstream lines{std::string(text)};
  std::string parent;
  int number = 0;
  std::string* open_list = nullptr;  // a flow list that goes on over several lines
  const auto is_open = [](const std::string& list) {
    return std::count(list.begin(), list.end(), '[') > std::count(list.begin(), list.end(), ']');
  };
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (open_list != nullptr) {
      *open_list += " " + line;
      if (line.find(']') != std::string::npos && !is_open(*open_list)) open_list = nullptr;
      continue;
    }
    const std::string content = trimmed(line.substr(0, line.find(" #")));
    const std::size_t colon = content.find(':');
    if (content.empty() || content[0] == '%' || content[0] == '#' || colon == std::string::npos)
      continue;
    const bool nested = line[0] == ' ' || line[0] == '\t';
    const std::string key = trimmed(content.substr(0, colon));
    std::string value = trimmed(content.substr(colon + 1));
    if (!nested) parent = key;
    if (value.rfind("!!", 0) == 0) value.clear();  // !!opencv-matrix
    const std::string name = nested ? parent + "." + key : key;
    values[name] = {value, number};
    if (is_open(value)) open_list = &values[name].text;
  }
  return values;
}

std::vector<double> numbers(const Value& value, const std::string& key, const std::string& file) {
  std::string text = value.text;
  for (char& c : text)
    if (c == '[' || c == ']' || c == ',') c = ' ';
  std::vector<double> result;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    double number = 0;
    const char* end = word.data() + word.size();
    const auto [rest, failed] = std::from_chars(word.data(), end, number);
    const bool trailing_dot =
        rest != end && *rest == '.' && rest + 1 == end;  // FileStorage writes "0."
    if (failed != std::errc() || (rest != end && !trailing_dot) || !std::isfinite(number))
      throw Error(key + " holds '" + word.substr(0, 40) + "'; expected a finite number",
                  {file, value.line});
    if (result.size() == 64) throw Error(key + " holds too many numbers", {file, value.line});
    result.push_back(number);
  }
  return result;
}

const Value* find(const Values& values, const std::vector<std::string>& keys, std::string* found) {
  for (const std::string& key : keys) {
    for (const std::string& name : {key + ".data", key}) {
      const auto at = values.find(name);
      if (at == values.end() || at->second.text.empty()) continue;
      *found = key;
      return &at->second;
    }
  }
  return nullptr;
}

int whole(const Values& values, const std::vector<std::string>& keys, const std::string& file) {
  std::string key;
  const Value* value = find(values, keys, &key);
  if (value == nullptr) return 0;
  const auto list = numbers(*value, key, file);
  if (list.size() != 1 || list[0] < 1 || list[0] > 65536)
    throw Error(key + " is '" + value->text.substr(0, 40) + "'; expected a size in pixels",
                {file, value->line});
  return static_cast<int>(list[0]);
}

bool says_fisheye(const Values& values, const std::string& file) {
  std::string key;
  if (const Value* value = find(values, {"fisheye_model", "fisheye"}, &key)) {
    const std::string flag = trimmed(value->text);
    if (flag == "1" || flag == "true") return true;
    if (flag == "0" || flag == "false") return false;
    throw Error(key + " is '" + flag.substr(0, 40) + "'; expected 0 or 1", {file, value->line});
  }
  const Value* model = find(values, {"distortion_model", "camera_model", "model"}, &key);
  if (model == nullptr) return false;
  const std::string& name = model->text;
  const auto is = [&](const char* word) { return name.find(word) != std::string::npos; };
  if (is("fisheye") || is("equidistant") || is("kannala")) return true;
  if (is("plumb_bob") || is("rational") || is("pinhole") || is("radtan") || is("brown") ||
      is("opencv"))
    return false;
  throw Error(
      key + " is '" + name.substr(0, 40) + "'; expected plumb_bob, rational_polynomial or fisheye",
      {file, model->line});
}

}  // namespace

Calibration parse_opencv_calibration(std::string_view text, const std::filesystem::path& name) {
  const std::string file = name.string();
  const Values values =
      name.extension() == ".xml" ? values_of_xml(text, file) : values_of_yaml(text);
  Calibration c;
  std::string key;
  const Value* matrix =
      find(values, {"camera_matrix", "Camera_Matrix", "cameraMatrix", "CameraMatrix", "K"}, &key);
  if (matrix == nullptr)
    throw Error("has no camera_matrix; expected an OpenCV calibration", {file});
  const auto m = numbers(*matrix, key, file);
  if (m.size() != 9)
    throw Error(key + " holds " + std::to_string(m.size()) + " numbers; expected 9",
                {file, matrix->line});
  std::copy(m.begin(), m.end(), c.camera_matrix.begin());
  const Value* distortion = find(values,
                                 {"distortion_coefficients",
                                  "Distortion_Coefficients",
                                  "distCoeffs",
                                  "dist_coeffs",
                                  "dist_coeff",
                                  "distortion",
                                  "D"},
                                 &key);
  if (distortion != nullptr) c.distortion = numbers(*distortion, key, file);
  c.size.width = whole(values, {"image_width", "image_Width", "width"}, file);
  c.size.height = whole(values, {"image_height", "image_Height", "height"}, file);
  if ((c.size.width == 0) != (c.size.height == 0))
    throw Error("has only one of image_width and image_height; expected both or none", {file});
  c.fisheye = says_fisheye(values, file);
  return c;
}

}  // namespace airtruth::lens
