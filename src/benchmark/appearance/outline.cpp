// SPDX-License-Identifier: Apache-2.0
#include "benchmark/appearance/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "foundation/base/median.h"

namespace airtruth::appearance {
namespace {

constexpr double kReachPx = 4;            // of a profile to either side of the outline
constexpr double kStepPx = 0.25;          // from sample to sample along it
constexpr double kMinSlope = 3;           // code values a pixel: an edge that is clear
constexpr double kMinStep = 8;            // code values from side to side
constexpr std::size_t kHaloSamples = 16;  // outward of the edge's middle, as far as kReachPx
constexpr double kSobelGain = 8;          // OpenCV's 3 x 3 Sobel over the slope a pixel

// Bilinear between pixels; beyond the picture its border's value.
double sample_at(const cv::Mat& grey, double x, double y) {
  const double within_x = std::clamp(x, 0.0, grey.cols - 1.001);
  const double within_y = std::clamp(y, 0.0, grey.rows - 1.001);
  const int x0 = static_cast<int>(within_x), y0 = static_cast<int>(within_y);
  const double u = within_x - x0, v = within_y - y0;
  const float* above = grey.ptr<float>(y0) + x0;
  const float* below = grey.ptr<float>(y0 + 1) + x0;
  return (1 - v) * ((1 - u) * double(above[0]) + u * double(above[1])) +
         v * ((1 - u) * double(below[0]) + u * double(below[1]));
}

// Grey along the gradient, from dark to bright, and the rise through its middle.
struct Profile {
  std::vector<double> values;
  std::size_t low = 0, high = 0;  // the turning points

  double step() const { return values[high] - values[low]; }
  // Where the rise passes a share of itself, in samples.
  double crossing(double share) const {
    const double level = values[low] + share * step();
    std::size_t i = low;
    while (i < high && values[i + 1] < level) ++i;
    return double(i) + (level - values[i]) / std::max(1e-9, values[i + 1] - values[i]);
  }
};

std::optional<Profile> profile_at(const cv::Mat& grey, int x, int y, double dx, double dy) {
  Profile profile;
  for (double p = -2 * kReachPx; p <= 2 * kReachPx; p += kStepPx)
    profile.values.push_back(sample_at(grey, x + p * dx, y + p * dy));
  const std::size_t middle = profile.values.size() / 2;
  const auto reach = static_cast<std::size_t>(kReachPx / kStepPx);
  profile.low = profile.high = middle;
  while (profile.low > middle - reach &&
         profile.values[profile.low - 1] < profile.values[profile.low])
    --profile.low;
  while (profile.high < middle + reach &&
         profile.values[profile.high + 1] > profile.values[profile.high])
    ++profile.high;
  if (profile.step() < kMinStep) return std::nullopt;
  return profile;
}

// The profile outward of the edge's middle, 0 the aircraft's level at the edge, 1 that of the sky.
std::array<double, kHaloSamples> outward_of(const Profile& profile,
                                            bool sky_is_bright,
                                            double sky) {
  const double inside = profile.values[sky_is_bright ? profile.low : profile.high];
  const double middle = profile.crossing(0.5);
  std::array<double, kHaloSamples> result{};
  for (std::size_t i = 0; i < kHaloSamples; ++i) {
    const double at = middle + (sky_is_bright ? 1.0 : -1.0) * double(i + 1);
    const auto below = static_cast<std::size_t>(
        std::clamp(std::floor(at), 0.0, double(profile.values.size() - 2)));
    const double t = at - double(below);
    const double value = (1 - t) * profile.values[below] + t * profile.values[below + 1];
    result[i] = (value - inside) / (sky - inside);
  }
  return result;
}

}  // namespace

Outline outline_of(const cv::Mat& grey, const cv::Mat& silhouette, const cv::Mat& level) {
  cv::Mat soft, gx, gy, rim;
  cv::GaussianBlur(grey, soft, {}, 0.7);
  cv::Sobel(soft, gx, CV_32F, 1, 0);
  cv::Sobel(soft, gy, CV_32F, 0, 1);
  cv::morphologyEx(
      silhouette, rim, cv::MORPH_GRADIENT, cv::getStructuringElement(cv::MORPH_CROSS, {3, 3}));
  std::vector<double> widths;
  std::array<std::vector<double>, kHaloSamples> outward;
  const int border = static_cast<int>(kReachPx) + 1;
  for (int y = border; y + border < grey.rows; ++y)
    for (int x = border; x + border < grey.cols; ++x) {
      if (rim.at<unsigned char>(y, x) == 0) continue;
      const double dx = double(gx.at<float>(y, x)), dy = double(gy.at<float>(y, x));
      const double slope = std::hypot(dx, dy);
      if (slope < kSobelGain * kMinSlope) continue;
      const auto profile = profile_at(grey, x, y, dx / slope, dy / slope);
      if (!profile) continue;
      widths.push_back(kStepPx * (profile->crossing(0.9) - profile->crossing(0.1)));
      const double sky = double(level.at<float>(y, x));
      const bool sky_is_bright = std::abs(sky - profile->values[profile->high]) <
                                 std::abs(sky - profile->values[profile->low]);
      const double inside = profile->values[sky_is_bright ? profile->low : profile->high];
      // A step within the aircraft says nothing about the sky beside it.
      if (std::abs(sky - inside) < kMinStep) continue;
      const auto part = outward_of(*profile, sky_is_bright, sky);
      for (std::size_t i = 0; i < kHaloSamples; ++i) outward[i].push_back(part[i]);
    }
  Outline result;
  result.edge_width_px = median_or_0(std::move(widths));
  double most = 0;
  for (std::vector<double>& values : outward)
    if (!values.empty()) most = std::max(most, median(std::move(values)) - 1);
  result.halo = most;
  return result;
}

}  // namespace airtruth::appearance
