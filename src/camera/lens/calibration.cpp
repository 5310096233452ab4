// SPDX-License-Identifier: Apache-2.0
#include "camera/lens/calibration.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <pugixml.hpp>
#include <yaml-cpp/yaml.h>

#include "foundation/base/error.h"
#include "foundation/base/names.h"
#include "foundation/base/text.h"
#include "foundation/json/json_object.h"

// OpenCV's FileStorage, as its calibration samples, kalibr-like tools and ROS write it: XML through
// pugixml, YAML through yaml-cpp, which refuses nesting beyond 500 levels and keeps an alias as a
// reference.
namespace airtruth::lens {
namespace {

// Refuses properties that change the position of a ray and that no lens model here has.
void refuse_what_cannot_be_honoured(const JsonObject& profile) {
  for (const char* key : {"input_horizontal_stretch", "input_vertical_stretch"})
    if (profile.maybe_number(key).value_or(1) != 1)
      profile.fail(key, "1; an anamorphic stretch cannot be honoured");
  const std::string model = profile.maybe_text("distortion_model").value_or("");
  if (!model.empty() && model != "opencv_fisheye")
    profile.fail("distortion_model",
                 "opencv_fisheye; no other model of Gyroflow's can be honoured");
  for (const char* key : {"digital_lens", "digital_lens_params"})
    if (!profile.maybe_text(key).value_or("").empty())
      profile.fail(key, "none; a digital lens cannot be honoured");
  if (profile.has("interpolations") && !profile.is_empty("interpolations"))
    profile.fail("interpolations", "none; a lens that changes with its zoom cannot be honoured");
  if (profile.maybe_truth("use_opencv_standard").value_or(false))
    profile.fail("use_opencv_standard", "false; no other model than the fisheye can be honoured");
  if (profile.maybe_number("crop").value_or(1) != 1)
    profile.fail("crop", "1; a crop cannot be honoured");
}

// The limit in a Gyroflow profile is a radius on the plane at distance 1, tan(angle); 0 means that
// there is none.
double stated_max_angle(const JsonObject& fisheye) {
  const char* key = "radial_distortion_limit";
  const double limit = fisheye.maybe_number(key).value_or(0);
  if (limit < 0) fisheye.fail(key, "the tangent of an angle, from 0");
  return limit == 0 ? kPi : std::atan(limit);
}

// The brand and the model, without characters that would break a message's line.
std::string camera_of(const JsonObject& profile) {
  std::string camera;
  for (const char* key : {"camera_brand", "camera_model"}) {
    const std::string text = profile.maybe_text(key).value_or("");
    if (!text.empty()) camera += (camera.empty() ? "" : " ") + text;
  }
  std::erase_if(camera, is_control);
  return camera;
}

}  // namespace

Calibration parse_gyroflow_profile(std::string_view text, const std::filesystem::path& name) {
  const JsonDocument document(text, {name.string()});
  const JsonObject profile = document.with_lines_of(text);
  refuse_what_cannot_be_honoured(profile);
  if (!profile.has("fisheye_params"))
    profile.fail("has no fisheye_params; expected a Gyroflow lens profile");
  const JsonObject fisheye = profile.object("fisheye_params");
  const JsonObject size = profile.object("calib_dimension");
  Calibration c;
  c.fisheye = true;
  const std::vector<double> matrix = fisheye.matrix("camera_matrix", 3, 3);
  std::copy(matrix.begin(), matrix.end(), c.camera_matrix.begin());
  c.distortion = fisheye.numbers("distortion_coeffs", 4);
  c.max_angle_rad = stated_max_angle(fisheye);
  c.size = {static_cast<int>(size.whole("w", 1, 65536)),
            static_cast<int>(size.whole("h", 1, 65536))};
  c.camera = camera_of(profile);
  return c;
}

namespace {

struct Value {
  std::string key;  // without ".data"
  std::string text;
  Where where;
};
// A calibration of 14 coefficients has about 1 kB. yaml-cpp takes about 3 s for the worst text of 1
// MB.
constexpr std::size_t kLargestYaml_bytes = std::size_t{1} << 20;
// A matrix and a list of coefficients hold at most 64 numbers.
constexpr std::size_t kLongestValue_bytes = 4096;

// "camera_matrix.data" -> "[ 1, 0, ... ]", as often as the file has it.
using Values = std::multimap<std::string, Value>;

void keep(Values& values, const std::string& name, const std::string& text, const Where& where) {
  const std::string key = name.ends_with(".data") ? name.substr(0, name.size() - 5) : name;
  values.emplace(name, Value{key, text, where});
}

Values values_of_xml(std::string_view text, const std::string& file) {
  pugi::xml_document document;
  const auto parsed = document.load_buffer(text.data(), text.size());
  if (!parsed)
    throw Error(std::string("is not XML: ") + parsed.description(),
                {file, line_of(text, parsed.offset)});
  Values values;
  for (const pugi::xml_node node : document.child("opencv_storage")) {
    const pugi::xml_node data = node.child("data");
    keep(values,
         std::string(node.name()) + (data ? ".data" : ""),
         (data ? data : node).text().get(),
         {file, line_of(text, node.offset_debug())});
  }
  if (values.empty())
    throw Error("holds no <opencv_storage> with values; expected an OpenCV calibration", {file});
  return values;
}

// Appends the scalars of a value, a list, or a list of lists to `text`. An alias can stand for a
// list of aliases, so both the length of the text and the depth are bounded.
void append(const YAML::Node& node, int depth, std::string& text) {
  if (text.size() > kLongestValue_bytes) return;
  if (node.IsScalar()) text += (text.empty() ? "" : " ") + node.Scalar();
  if (!node.IsSequence() || depth == 0) return;
  for (const YAML::Node& element : node) append(element, depth - 1, text);
}

std::string scalars_of(const YAML::Node& node) {
  std::string text;
  append(node, 2, text);
  return text;
}

// The camera of a Kalibr camchain, whose top level has cam0, cam1 and so on; undefined for any
// other file.
YAML::Node only_camera(const YAML::Node& top, const std::string& file) {
  YAML::Node camera(YAML::NodeType::Undefined);
  for (const auto& entry : top) {
    if (!entry.first.IsScalar() || !entry.second.IsMap()) continue;
    const YAML::Node intrinsics = entry.second["intrinsics"];
    if (!intrinsics.IsDefined()) continue;
    if (camera.IsDefined())
      throw Error("holds several cameras (cam0, cam1, ...); expected a file of the one that flew",
                  {file, entry.first.Mark().line + 1});
    camera.reset(entry.second);
  }
  return camera;
}

// Where a second document begins; the text's size: nowhere. yaml-cpp's own LoadAll() takes what
// follows a whole document, such as a comma, for documents without end.
std::size_t second_document(std::string_view text) {
  bool is_begun = false;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view row = text.substr(begin, end - begin), line = trimmed(row);
    const auto is_mark = [&](const char* mark) {
      return row.starts_with(mark) && trimmed(row.substr(3, 1)).empty();
    };
    if (is_mark("---")) {
      if (is_begun) return begin;
      is_begun = line.size() > 3;
    } else if (is_mark("...")) {
      if (is_begun) return std::min(end + 1, text.size());
    } else if (!line.empty() && line.front() != '#' && line.front() != '%') {
      is_begun = true;
    }
    begin = end + 1;
  }
  return text.size();
}

YAML::Node document_of(std::string_view text, int lines_before, const std::string& file) {
  try {
    return YAML::Load(std::string(text));
  } catch (const YAML::Exception& error) {
    throw Error("is not YAML: " + error.msg, {file, lines_before + error.mark.line + 1});
  }
}

Values values_of_yaml(std::string_view text, const std::string& file) {
  if (text.size() > kLargestYaml_bytes)
    throw Error("is larger than 1 MiB; expected an OpenCV calibration", {file});
  text = without_mark(text);
  Values values;
  const std::size_t end = second_document(text);
  const YAML::Node document = document_of(text.substr(0, end), 0, file);
  // A second document is a key that nothing reads.
  const int line = line_of(text, static_cast<std::ptrdiff_t>(end));
  if (document_of(text.substr(end), line - 1, file).IsMap()) keep(values, "---", "", {file, line});
  if (!document.IsMap()) return values;
  YAML::Node top = document;
  if (const YAML::Node camera = only_camera(top, file); camera.IsMap()) top.reset(camera);
  for (const auto& entry : top) {
    const YAML::Node& name = entry.first;
    const YAML::Node& node = entry.second;
    if (!name.IsScalar()) continue;
    const YAML::Node data = node.IsMap() ? node["data"] : YAML::Node(YAML::NodeType::Undefined);
    const bool has_data = data.IsDefined();
    keep(values,
         name.Scalar() + (has_data ? ".data" : ""),
         scalars_of(has_data ? data : node),
         {file, name.Mark().line + 1});
  }
  return values;
}

// Without the brackets and commas of a list.
std::istringstream words_of(const Value& value) {
  std::string text = value.text;
  for (char& c : text)
    if (c == '[' || c == ']' || c == ',') c = ' ';
  return std::istringstream(text);
}

std::vector<double> numbers(const Value& value) {
  std::vector<double> result;
  std::istringstream words = words_of(value);
  for (std::string word; words >> word;) {
    double number = 0;
    const char* end = word.data() + word.size();
    const auto [rest, failed] = std::from_chars(word.data(), end, number);
    const bool trailing_dot =
        rest != end && *rest == '.' && rest + 1 == end;  // FileStorage writes "0."
    if (failed != std::errc() || (rest != end && !trailing_dot) || !std::isfinite(number))
      throw Error(value.key + " holds '" + word.substr(0, 40) + "'; expected a finite number",
                  value.where);
    if (result.size() == 64) throw Error(value.key + " holds too many numbers", value.where);
    result.push_back(number);
  }
  return result;
}

// Whether two values are of the same numbers ("600." is 600) or words.
bool say_the_same(const Value& a, const Value& b) {
  std::istringstream of_a = words_of(a), of_b = words_of(b);
  for (std::string x, y;;) {
    const bool has_x(of_a >> x), has_y(of_b >> y);
    if (!has_x || !has_y) return has_x == has_y;
    double number_x = 0, number_y = 0;
    const bool are_numbers =
        std::from_chars(x.data(), x.data() + x.size(), number_x).ec == std::errc() &&
        std::from_chars(y.data(), y.data() + y.size(), number_y).ec == std::errc();
    if (are_numbers ? number_x != number_y : x != y) return false;
  }
}

// The value of the keys of one meaning; nullptr where the file has none. Throws Error where it has
// two that differ.
const Value* find(const Values& values, const std::vector<std::string>& keys) {
  const Value* first = nullptr;
  for (const std::string& key : keys) {
    for (const std::string& name : {key + ".data", key}) {
      const auto [begin, end] = values.equal_range(name);
      for (auto at = begin; at != end; ++at) {
        const Value& value = at->second;
        if (value.text.empty()) continue;
        if (first == nullptr)
          first = &value;
        else if (!say_the_same(*first, value))
          throw Error(fmt::format("{} differs from {} in line {}; expected one lens",
                                  value.key,
                                  first->key,
                                  first->where.line),
                      value.where);
      }
    }
  }
  return first;
}

int whole(const Values& values, const std::vector<std::string>& keys) {
  const Value* value = find(values, keys);
  if (value == nullptr) return 0;
  const auto list = numbers(*value);
  if (list.size() != 1 || list[0] < 1 || list[0] > 65536)
    throw Error(value->key + " is '" + value->text.substr(0, 40) + "'; expected a size in pixels",
                value->where);
  return static_cast<int>(list[0]);
}

const std::vector<std::string> kMatrix = {
    "camera_matrix", "Camera_Matrix", "cameraMatrix", "CameraMatrix", "camera_mat", "K", "k"};
const std::vector<std::string> kDistortion = words_in(
    "distortion_coefficients Distortion_Coefficients distortion_coeffs distCoeffs dist_coeffs "
    "dist_coeff distortion dist D d");
const std::vector<std::string> kWidth = {"image_width", "image_Width", "width"};
const std::vector<std::string> kHeight = {"image_height", "image_Height", "height"};
const std::vector<std::string> kBothSides = {
    "image_size", "imageSize", "image_Size", "img_size", "resolution"};
const std::vector<std::string> kFisheyeFlag = {"fisheye_model", "fisheye"};
const std::vector<std::string> kModels = {"distortion_model", "camera_model", "model"};
// Kalibr's.
const std::vector<std::string> kIntrinsics = {"intrinsics"};

// Keys that change no ray: who calibrated when and how well, and where the camera stands. ROS's
// rectification and projection matrices are those of the rectified picture.
const std::vector<std::string> kHarmless = words_in(
    "calibration_time calibration_date nframes nr_of_frames board_width board_height square_size "
    "marker_size aspectRatio aspect_ratio fix_aspect_ratio flags flagValue "
    "avg_reprojection_error Avg_Reprojection_Error rms RMS reprojection_error "
    "per_view_reprojection_errors Per_View_Reprojection_Errors extrinsic_parameters "
    "Extrinsic_Parameters image_points Image_points grid_points write_grid camera_name header "
    "rectification_matrix projection_matrix R P r p cam_overlaps rostopic T_cam_imu T_cn_cnm1 "
    "T_imu_cam timeshift_cam_imu");

// Words of names of lens models: those that tell one kind, and those that stand beside them.
const std::vector<std::string> kFisheyeWords =
    words_in("fisheye equidistant equi kannala kannalabrandt");
const std::vector<std::string> kBesideFisheye =
    words_in("opencv cv pinhole radial simple brandt camera lens model distortion");
const std::vector<std::string> kPinholeWords =
    words_in("pinhole plumb plumbbob rational radtan radial brown brownconrady opencv none");
const std::vector<std::string> kBesidePinhole =
    words_in("bob polynomial conrady tangential simple full cv camera lens model distortion");

bool is_among(const std::string& key, const std::vector<std::string>& keys) {
  return std::ranges::find(keys, key) != keys.end();
}

// Names of lens models, in any of kModels, whatever their case: true for a fisheye, false for a
// pinhole with or without distortion. Throws Error for any other, such as a name with a word that
// is not known.
bool is_fisheye_model(const Value& value) {
  std::string letters = lower_case(value.text);
  std::ranges::replace_if(
      letters, [](char c) { return c < 'a' || c > 'z'; }, ' ');
  const std::vector<std::string> words = words_in(letters);
  const auto is_named_by = [&](const auto& telling, const auto& beside) {
    const auto tells = [&](const std::string& word) { return is_among(word, telling); };
    return std::ranges::any_of(words, tells) &&
           std::ranges::all_of(words, [&](const std::string& word) {
             return tells(word) || is_among(word, beside);
           });
  };
  if (is_named_by(kFisheyeWords, kBesideFisheye)) return true;
  if (is_named_by(kPinholeWords, kBesidePinhole)) return false;
  throw Error(value.key + " is '" + value.text.substr(0, 40) +
                  "', a lens model that cannot be honoured; expected pinhole, plumb_bob, radtan, "
                  "rational_polynomial, fisheye or equidistant",
              value.where);
}

// Whether the file says that its lens is a fisheye; empty where it says nothing.
std::optional<bool> says_fisheye(const Values& values) {
  if (const Value* value = find(values, kFisheyeFlag)) {
    const std::string flag(airtruth::trimmed(value->text));
    if (flag == "1" || flag == "true") return true;
    if (flag == "0" || flag == "false") return false;
    throw Error(value->key + " is '" + flag.substr(0, 40) + "'; expected 0 or 1", value->where);
  }
  // Kalibr states two: the projection and the distortion. The second decides.
  std::optional<bool> says;
  for (const std::string& name : kModels)
    if (const Value* model = find(values, {name})) {
      const bool is_fisheye = is_fisheye_model(*model);
      says = says.value_or(false) || is_fisheye;
    }
  return says;
}

// ROS's region of interest and binning: nothing where they are 0 or 1, as drivers write them.
bool is_idle(const Value& value) {
  if (value.key != "binning_x" && value.key != "binning_y") return false;
  const std::vector<double> list = numbers(value);
  return list.size() == 1 && (list[0] == 0 || list[0] == 1);
}

// Keys that are neither used nor harmless: an error where the name is one of a lens's, and a
// warning else.
void expect_known_keys(const Values& values, Calibration& c) {
  for (const auto& [name, value] : values) {
    const std::string& key = value.key;
    bool is_known = is_among(key, kHarmless) || is_idle(value);
    for (const auto& keys :
         {kMatrix, kDistortion, kWidth, kHeight, kBothSides, kFisheyeFlag, kModels, kIntrinsics})
      is_known = is_known || is_among(key, keys);
    if (is_known) continue;
    const std::string small = lower_case(key);
    for (const char* word : {"dist", "coef", "fisheye", "matrix", "model"})
      if (small.find(word) != std::string::npos)
        throw Error("has '" + key.substr(0, 60) +
                        "', which is no key that is known; expected camera_matrix, "
                        "distortion_coefficients, distortion_model and the like",
                    value.where);
    if (small == "xi")
      throw Error("has xi, the parameter of a lens model that cannot be honoured", value.where);
    c.unread.push_back(
        fmt::format("{}: '{}' is not read", to_string(value.where), key.substr(0, 60)));
  }
}

// The sizes of a camera by one key with both sides, or by two.
ImageSize size_in(const Values& values, const std::string& file) {
  const ImageSize size{whole(values, kWidth), whole(values, kHeight)};
  if (const Value* both = find(values, kBothSides)) {
    const auto list = numbers(*both);
    for (const double side : list)
      if (list.size() != 2 || side < 1 || side > 65536 || side != std::floor(side))
        throw Error(both->key + " is '" + both->text.substr(0, 40) + "'; expected [width, height]",
                    both->where);
    if (list.size() == 2) {
      if ((size.width != 0 && size.width != list[0]) ||
          (size.height != 0 && size.height != list[1]))
        throw Error(both->key + " differs from " + std::to_string(size.width) + "x" +
                        std::to_string(size.height) + " of two keys; expected one size",
                    both->where);
      return {static_cast<int>(list[0]), static_cast<int>(list[1])};
    }
  }
  if ((size.width == 0) != (size.height == 0))
    throw Error("has only one of image_width and image_height; expected both or none", {file});
  return size;
}

std::array<double, 9> matrix_in(const Values& values, const std::string& file) {
  std::array<double, 9> matrix{};
  if (const Value* value = find(values, kMatrix)) {
    const auto m = numbers(*value);
    if (m.size() != 9)
      throw Error(value->key + " holds " + std::to_string(m.size()) + " numbers; expected 9",
                  value->where);
    std::copy(m.begin(), m.end(), matrix.begin());
    return matrix;
  }
  const Value* intrinsics = find(values, kIntrinsics);
  if (intrinsics == nullptr)
    throw Error(
        "has no camera_matrix; expected a calibration of OpenCV, ROS or Kalibr, or a .json of "
        "Gyroflow with fisheye_params",
        {file});
  const auto n = numbers(*intrinsics);
  if (n.size() != 4)
    throw Error(
        "intrinsics holds " + std::to_string(n.size()) + " numbers; expected fx, fy, cx, cy",
        intrinsics->where);
  return {n[0], 0, n[2], 0, n[1], n[3], 0, 0, 1};
}

}  // namespace

Calibration parse_opencv_calibration(std::string_view text, const std::filesystem::path& name) {
  const std::string file = name.string();
  const Values values = lower_case(name.extension().string()) == ".xml"
                            ? values_of_xml(text, file)
                            : values_of_yaml(text, file);
  Calibration c;
  c.camera_matrix = matrix_in(values, file);
  const Value* distortion = find(values, kDistortion);
  if (distortion != nullptr) c.distortion = numbers(*distortion);
  c.size = size_in(values, file);
  expect_known_keys(values, c);
  const std::optional<bool> is_fisheye = says_fisheye(values);
  // cv2.fisheye.calibrate gives four coefficients, and cv2.calibrateCamera may.
  if (!is_fisheye && c.distortion.size() == 4 &&
      std::ranges::any_of(c.distortion, [](double k) { return k != 0; }))
    throw Error(distortion->key +
                    " holds four numbers, and nothing says of which model; expected "
                    "`fisheye_model: 1` (cv2.fisheye) or `fisheye_model: 0` "
                    "(cv2.calibrateCamera) beside them",
                distortion->where);
  c.fisheye = is_fisheye.value_or(false);
  return c;
}

}  // namespace airtruth::lens
