// SPDX-License-Identifier: Apache-2.0
#include "lens/calibration_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <string>

#include "base/error.h"
#include "base/files.h"
#include "lens/calibration.h"

namespace airtruth::lens {
namespace {

constexpr std::size_t kMaxBytes = 16u << 20;
constexpr double kAspectTolerance = 0.01;
// As the keys of [lens] in a scene (scene/limits.h).
constexpr double kLeastFocal_px = 1;
constexpr double kFarthest_px = 1e6;
constexpr double kLargestCoefficient = 1e6;

std::string shown(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", number);
  return text;
}

void check_matrix(const Calibration& c, const std::string& file) {
  for (double value : c.camera_matrix)
    if (!std::isfinite(value))
      throw Error("the camera matrix holds a number that is not finite", {file});
  const auto& m = c.camera_matrix;
  if (std::abs(m[1]) > 1e-9)
    throw Error("the camera matrix has a skew of " + std::to_string(m[1]) +
                    "; expected 0 (no lens model here has skew)",
                {file});
  for (const std::size_t i : {std::size_t{0}, std::size_t{4}})
    if (!(m[i] >= kLeastFocal_px && m[i] <= kFarthest_px))
      throw Error(
          "the camera matrix has a focal length of " + shown(m[i]) + "; expected 1 to 1e6 pixels",
          {file});
  for (const std::size_t i : {std::size_t{2}, std::size_t{5}})
    if (std::abs(m[i]) > kFarthest_px)
      throw Error("the camera matrix has its centre at " + shown(m[i]) + "; expected it within 1e6",
                  {file});
  for (const double k : c.distortion)
    if (!(std::abs(k) <= kLargestCoefficient))
      throw Error("has a distortion coefficient of " + shown(k) + "; expected it within 1e6",
                  {file});
  if (m[3] != 0 || m[6] != 0 || m[7] != 0 || m[8] != 1)
    throw Error("the camera matrix is not of the form [fx 0 cx; 0 fy cy; 0 0 1]", {file});
}

// The file's size to ours: the same aspect ratio, another resolution.
Pixel scale_of(ImageSize from, ImageSize to, const std::string& file) {
  const Pixel scale(static_cast<double>(to.width) / from.width,
                    static_cast<double>(to.height) / from.height);
  if (std::abs(scale.x() / scale.y() - 1) > kAspectTolerance)
    throw Error("was made for " + std::to_string(from.width) + "x" + std::to_string(from.height) +
                    ", but the video is " + std::to_string(to.width) + "x" +
                    std::to_string(to.height) + "; expected the same aspect ratio",
                {file});
  return scale;
}

std::vector<double> trimmed(std::vector<double> distortion, bool fisheye, const std::string& file) {
  const std::size_t most = fisheye ? 4 : 8;
  for (std::size_t i = most; i < distortion.size(); ++i)
    if (distortion[i] != 0)
      throw Error("distortion coefficient " + std::to_string(i + 1) +
                      (fisheye ? " of a fisheye" : " (thin prism or tilt)") +
                      " is not 0; no lens model here has it",
                  {file});
  std::size_t size = std::min(distortion.size(), most);
  if (!fisheye) {
    const auto zero_from = [&](std::size_t i) {
      return std::all_of(distortion.begin() + static_cast<std::ptrdiff_t>(std::min(i, size)),
                         distortion.begin() + static_cast<std::ptrdiff_t>(size),
                         [](double k) { return k == 0; });
    };
    size = size <= 4 || zero_from(4) ? 4 : size == 5 || zero_from(5) ? 5 : 8;
  } else {
    size = 4;
  }
  distortion.resize(size, 0.0);
  return distortion;
}

}  // namespace

Lens parse_calibration(std::string_view text, const std::filesystem::path& name, ImageSize size) {
  const std::string file = name.string();
  std::string extension = name.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  Calibration c;
  if (extension == ".json") {
    c = parse_gyroflow_profile(text, name);
  } else if (extension == ".yml" || extension == ".yaml" || extension == ".xml") {
    c = parse_opencv_calibration(text, name);
  } else {
    throw Error("is no calibration file: expected .json (Gyroflow) or .yml, .yaml, .xml (OpenCV)",
                {file});
  }
  check_matrix(c, file);
  if (c.size.width <= 0 || c.size.height <= 0) c.size = size;
  const Pixel scale = scale_of(c.size, size, file);
  const Pixel focal(c.camera_matrix[0] * scale.x(), c.camera_matrix[4] * scale.y());
  // OpenCV's (0, 0) is the middle of the first pixel; ours is its corner.
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

Lens read_calibration(const std::filesystem::path& path, ImageSize size) {
  return parse_calibration(read_file(path, kMaxBytes), path, size);
}

}  // namespace airtruth::lens
