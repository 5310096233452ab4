// SPDX-License-Identifier: Apache-2.0
#include "camera/lens/calibration_file.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "camera/lens/calibration.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "foundation/base/text.h"

namespace airtruth::lens {
namespace {

// The largest file that is read. Chosen: far above any calibration, and little of a machine's
// memory.
constexpr std::size_t kMaxBytes = 16u << 20;
// The largest relative difference of two aspect ratios that count as one: sizes are rounded to
// whole, often to even pixels. 4:3 and 16:9 differ by 33 %.
constexpr double kAspectTolerance = 0.01;
// The limits, in px and without a unit, of the keys of [lens] in a scene (scene/scene/limits.h).
constexpr double kMinFocal_px = 1;
constexpr double kFarthest_px = 1e6;
constexpr double kLargestCoefficient = 1e12;

std::string shown(double number) { return fmt::format("{:g}", number); }

void check_matrix(const Calibration& c, const std::string& file) {
  const auto& m = c.camera_matrix;
  if (!std::ranges::all_of(m, [](double value) { return std::isfinite(value); }))
    throw Error("the camera matrix holds a number that is not finite", {file});
  if (std::abs(m[1]) > 1e-9)
    throw Error("the camera matrix has a skew of " + std::to_string(m[1]) +
                    "; expected 0 (no lens model here has skew)",
                {file});
  for (const std::size_t i : {std::size_t{0}, std::size_t{4}})
    if (!(m[i] >= kMinFocal_px && m[i] <= kFarthest_px))
      throw Error(
          "the camera matrix has a focal length of " + shown(m[i]) + "; expected 1 to 1e6 pixels",
          {file});
  for (const std::size_t i : {std::size_t{2}, std::size_t{5}})
    if (std::abs(m[i]) > kFarthest_px)
      throw Error("the camera matrix has its centre at " + shown(m[i]) + "; expected it within 1e6",
                  {file});
  for (const double k : c.distortion)
    if (!(std::abs(k) <= kLargestCoefficient))
      throw Error("has a distortion coefficient of " + shown(k) + "; expected it within 1e12",
                  {file});
  if (m[3] != 0 || m[6] != 0 || m[7] != 0 || m[8] != 1)
    throw Error("the camera matrix is not of the form [fx 0 cx; 0 fy cy; 0 0 1]", {file});
}

bool same_aspect(ImageSize a, ImageSize b) {
  const double ratio = static_cast<double>(a.width) * b.height / a.height / b.width;
  return std::abs(ratio - 1) <= kAspectTolerance;
}

std::string words(ImageSize size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

std::vector<double> trimmed(std::vector<double> distortion, bool fisheye, const std::string& file) {
  const std::size_t most = fisheye ? 4 : 8;
  for (std::size_t i = most; i < distortion.size(); ++i)
    if (distortion[i] != 0)
      throw Error("distortion coefficient " + std::to_string(i + 1) +
                      (fisheye ? " of a fisheye" : " (thin prism or tilt)") +
                      " is not 0; no lens model here has it",
                  {file});
  distortion.resize(most, 0.0);
  std::size_t used = most;
  while (used > 4 && distortion[used - 1] == 0) --used;
  distortion.resize(used > 5 ? 8 : used);
  return distortion;
}

Calibration parsed(std::string_view text, const std::filesystem::path& name) {
  const std::string extension = lower_case(name.extension().string());
  const auto says = [&](const char* word) { return text.find(word) != std::string_view::npos; };
  // OpenCV's JSON is YAML too.
  const bool is_gyroflow =
      extension == ".json" && (says("calib_dimension") || says("fisheye_params"));
  const bool is_agisoft = extension == ".xml" && says("<calibration>");
  const bool is_known = extension == ".json" || extension == ".yml" || extension == ".yaml" ||
                        extension == ".xml" || extension == ".txt";
  if (!is_known)
    throw Error(
        "is no calibration file: expected .json (Gyroflow or OpenCV), .yml or .yaml (OpenCV, "
        "ROS or Kalibr), .xml (OpenCV or Agisoft) or .txt (COLMAP)",
        {name.string()});
  Calibration c = is_gyroflow           ? parse_gyroflow_profile(text, name)
                  : is_agisoft          ? parse_agisoft_calibration(text, name)
                  : extension == ".txt" ? parse_colmap_cameras(text, name)
                                        : parse_opencv_calibration(text, name);
  check_matrix(c, name.string());
  return c;
}

bool has_size(const Calibration& c) { return c.size.width > 0 && c.size.height > 0; }

// Accepts a size of the same aspect ratio as the calibration's, and a calibration without a size.
Lens lens_from(const Calibration& c, const std::string& file, ImageSize size) {
  const ImageSize from = has_size(c) ? c.size : size;
  const Pixel scale(static_cast<double>(size.width) / from.width,
                    static_cast<double>(size.height) / from.height);
  const Pixel focal(c.camera_matrix[0] * scale.x(), c.camera_matrix[4] * scale.y());
  // OpenCV's (0, 0) is the centre of the first pixel; airtruth's is its corner.
  const Pixel centre((c.camera_matrix[2] + 0.5) * scale.x(),
                     (c.camera_matrix[5] + 0.5) * scale.y());
  const std::vector<double> distortion = trimmed(c.distortion, c.fisheye, file);
  try {
    if (c.fisheye) return Lens(Fisheye{focal, centre, distortion, c.max_angle_rad}, size);
    if (std::all_of(distortion.begin(), distortion.end(), [](double k) { return k == 0; }))
      return Lens(Pinhole{focal, centre}, size);
    return Lens(BrownConrady{focal, centre, distortion}, size);
  } catch (const Error& error) {
    throw Error(error.message(), {file});
  }
}

std::string refusal(const Calibration& c, ImageSize size) {
  return "was made for " + words(c.size) + (c.camera.empty() ? "" : " of a " + c.camera) +
         ", but the video is " + words(size) + ", another aspect ratio";
}

std::string how_to_crop(const std::filesystem::path& path, const Calibration& c, ImageSize size) {
  if (same_aspect(c.size, {size.height, size.width}))
    return "; the picture is turned by 90 degrees against the calibration: expected a calibration "
           "of the turned picture, or a video that is not turned";
  return "; where the video is the middle of that picture, cut and not squeezed, `airtruth lens "
         "crop " +
         pasted(path.string()) + " --size " + words(size) + " -o LENS.yml` writes its lens";
}

// Profiles of the same camera beside the file whose aspect ratio is the video's, at most three.
std::string profiles_that_fit(const std::filesystem::path& path,
                              const Calibration& c,
                              ImageSize size) {
  // Numbers of files and of names. Chosen: reading more files would delay the message, and more
  // names would not fit on its line.
  constexpr std::size_t kMaxFilesRead = 1000;
  constexpr std::size_t kMaxProfilesNamed = 3;
  std::error_code failed;
  // A text that is no file has none beside it.
  if (c.camera.empty() || !std::filesystem::exists(path, failed)) return "";
  std::vector<std::filesystem::path> files;
  for (std::filesystem::directory_iterator at(path.has_parent_path() ? path.parent_path() : ".",
                                              failed);
       !failed && at != std::filesystem::directory_iterator() && files.size() < kMaxFilesRead;
       at.increment(failed))
    if (at->path().extension() == ".json" && at->is_regular_file(failed))
      files.push_back(at->path());
  std::sort(files.begin(), files.end());
  std::string named;
  std::size_t count = 0;
  for (const std::filesystem::path& file : files) {
    try {
      const Calibration other = parse_gyroflow_profile(read_file(file, kMaxBytes), file);
      check_matrix(other, file.string());
      if (other.camera != c.camera || !same_aspect(other.size, size)) continue;
      if (++count <= kMaxProfilesNamed)
        named +=
            (named.empty() ? "" : ", ") + file.filename().string() + " (" + words(other.size) + ")";
    } catch (const Error&) {  // another kind of JSON file, or a profile that no lens model fits
    }
  }
  return named.empty() ? "" : "; of the same camera and the video's aspect ratio: " + named;
}

}  // namespace

Lens parse_calibration(std::string_view text,
                       const std::filesystem::path& name,
                       ImageSize size,
                       const Warn& warn) {
  const Calibration c = parsed(text, name);
  for (const std::string& unread : c.unread) airtruth::warn(warn, unread);
  if (has_size(c) && !same_aspect(c.size, size))
    throw Error(refusal(c, size) + profiles_that_fit(name, c, size) + how_to_crop(name, c, size),
                {name.string()});
  return lens_from(c, name.string(), size);
}

Lens read_calibration(const std::filesystem::path& path, ImageSize size, const Warn& warn) {
  return parse_calibration(read_file(path, kMaxBytes), path, size, warn);
}

Lens read_calibration(const std::filesystem::path& path) {
  const Calibration c = parsed(read_file(path, kMaxBytes), path);
  if (!has_size(c))
    throw Error(
        "does not say which picture size it was made for; expected image_width and "
        "image_height",
        {path.string()});
  return lens_from(c, path.string(), c.size);
}

namespace {

// Writes 1 as "1.0", because YAML and TOML distinguish whole numbers from other numbers.
std::string text_of(double value) {
  const std::string text = fmt::format("{}", value);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

std::string list_of(const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(text_of(value));
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string matrix_of(int rows, int columns, const std::vector<double>& values) {
  return fmt::format("!!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n",
                     rows,
                     columns,
                     list_of(values));
}

}  // namespace

Lens cropped(const Lens& lens, ImageSize size) {
  const ImageSize from = lens.size();
  const double scale = std::max(static_cast<double>(size.width) / from.width,
                                static_cast<double>(size.height) / from.height);
  const Pixel middle(from.width / 2.0, from.height / 2.0);
  const Pixel new_middle(size.width / 2.0, size.height / 2.0);
  Model model = lens.model();
  std::visit(
      [&](auto& m) {
        m.focal_px *= scale;
        m.principal_point_px = new_middle + scale * (m.principal_point_px - middle);
      },
      model);
  return Lens(model, size);
}

std::string opencv_calibration(const Lens& lens, const std::string& note) {
  const Facts facts = facts_of(lens);
  std::vector<double> distortion = facts.distortion;
  if (distortion.empty()) distortion.assign(4, 0.0);
  const bool fisheye = std::holds_alternative<Fisheye>(lens.model());
  std::string line = note;
  std::replace_if(line.begin(), line.end(), is_control, ' ');
  const Pixel centre = pixel_of(facts.principal_point_px) - Pixel::Constant(0.5);
  const std::vector<double> matrix = {
      facts.focal_px[0], 0, centre.x(), 0, facts.focal_px[1], centre.y(), 0, 0, 1};
  return fmt::format(
      "%YAML:1.0\n---\n# {}\nimage_width: {}\nimage_height: {}\nfisheye_model: "
      "{}\ncamera_matrix: {}distortion_coefficients: {}",
      line,
      lens.size().width,
      lens.size().height,
      fisheye ? 1 : 0,
      matrix_of(3, 3, matrix),
      matrix_of(static_cast<int>(distortion.size()), 1, distortion));
}

std::string scene_table(const Lens& lens) {
  const Facts facts = facts_of(lens);
  std::string text =
      fmt::format("[lens]\nmodel = \"{}\"\nfocal_px = [{}]\nprincipal_point_px = [{}]\n",
                  lens.name(),
                  list_of({facts.focal_px[0], facts.focal_px[1]}),
                  list_of({facts.principal_point_px[0], facts.principal_point_px[1]}));
  if (std::ranges::any_of(facts.distortion, [](double k) { return k != 0; }))
    text += fmt::format("distortion = [{}]\n", list_of(facts.distortion));
  return text;
}

}  // namespace airtruth::lens
