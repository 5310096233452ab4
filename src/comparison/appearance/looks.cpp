// SPDX-License-Identifier: Apache-2.0
#include "comparison/appearance/looks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "comparison/appearance/segment.h"
#include "foundation/base/median.h"
#include "foundation/geometry/box.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/colour.h"
#include "foundation/image/mats.h"

namespace airtruth::appearance {
namespace {

// Where a constant of this file states no origin, it is a choice.

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

constexpr double kPatchReach =
    0.35;  // of a patch's side: how far its aircraft may lie from its middle

std::vector<double> values_where(const cv::Mat& values, const cv::Mat& mask) {
  std::vector<double> result;
  for (int y = 0; y < values.rows; ++y)
    for (int x = 0; x < values.cols; ++x)
      if (mask.at<unsigned char>(y, x) != 0) result.push_back(double(values.at<float>(y, x)));
  return result;
}

double laplacian_deviation(const cv::Mat& grey, const cv::Mat& mask) {
  cv::Mat laplacian;
  const cv::Mat kernel = (cv::Mat_<float>(3, 3) << 1, -2, 1, -2, 4, -2, 1, -2, 1);
  cv::filter2D(grey, laplacian, CV_32F, kernel);
  std::vector<double> values = values_where(laplacian, mask);
  for (double& v : values) v = std::abs(v);
  // Of unit white noise: 1 (Immerkaer 1996).
  return kSigmaOfMad * median_or_0(std::move(values)) / 6;
}

// How much of the spectrum lies above a frequency, in cycles a pixel.
double share_above(const cv::Mat& grey, double frequency) {
  const int side = std::min(grey.rows, grey.cols) / 2 * 2;
  cv::Mat window, spectrum;
  cv::createHanningWindow(window, {side, side}, CV_32F);
  const cv::Mat square = grey(cv::Rect(0, 0, side, side));
  cv::Mat centred = square - cv::mean(square)[0];
  cv::dft(centred.mul(window), spectrum, cv::DFT_COMPLEX_OUTPUT);
  double fine = 0, all = 1e-9;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const double fy = double(std::min(y, side - y)) / side;
      const double fx = double(std::min(x, side - x)) / side;
      const auto v = spectrum.at<cv::Vec2f>(y, x);
      const double power = double(v[0]) * double(v[0]) + double(v[1]) * double(v[1]);
      all += power;
      if (std::hypot(fx, fy) > frequency) fine += power;
    }
  return fine / all;
}

// x0: of the patch in the picture, whose blocks begin at its own edge.
double blockiness(const cv::Mat& grey, int x0) {
  double on = 0, off = 0;
  int on_count = 0, off_count = 0;
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x + 1 < grey.cols; ++x) {
      const double d = std::abs(double(grey.at<float>(y, x + 1)) - double(grey.at<float>(y, x)));
      if ((x0 + x + 1) % 8 == 0)
        on += d, ++on_count;
      else
        off += d, ++off_count;
    }
  return (on / std::max(1, on_count) + 0.1) / (off / std::max(1, off_count) + 0.1);
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

std::optional<Patch> patch_of(const image::Picture& picture, const Box& box) {
  const double half = std::max(8.0, std::max(box.width, box.height));
  const int side = 2 * whole_pixels(std::ceil(half));
  const int x = whole_pixels(box.x + box.width / 2) - side / 2;
  const int y = whole_pixels(box.y + box.height / 2) - side / 2;
  if (x < 0 || y < 0 || x + side > picture.width || y + side > picture.height) return std::nullopt;
  const image::Rgb8 crop = image::rgb8_from_picture(picture, {x, y, side, side});
  Patch patch;
  patch.x = x;
  patch.y = y;
  patch.rgb = image::mat_of(crop).clone();
  patch.grey = float_luma(picture, {x, y, side, side});
  // The ground below goes on beyond the patch.
  patch.silhouette = silhouette_of(patch.grey, kPatchReach * side, true);
  return patch;
}

namespace {

// Grey less its surroundings, over the silhouette: what is brighter and what is darker, each by
// itself.
void add_contrast(const cv::Mat& difference, const cv::Mat& silhouette, Looks& looks) {
  const std::vector<double> values = values_where(difference, silhouette);
  if (values.empty()) return;
  for (const double v : values) {
    looks.peak_above = std::max(looks.peak_above, v);
    looks.peak_below = std::min(looks.peak_below, v);
    looks.mean_above += std::max(0.0, v) / double(values.size());
    looks.mean_below += std::min(0.0, v) / double(values.size());
  }
}

// The mean of the largest tenth, of one value at least.
double brightest_decile_of(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end(), std::greater<>());
  values.resize((values.size() + 9) / 10);
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

double strongest_red_of(const Patch& patch, const cv::Mat& around) {
  cv::Mat rgb, cr;
  patch.rgb.convertTo(rgb, CV_32F);
  cv::transform(rgb, cr, cv::Matx13f(0.5F, -0.418688F, -0.081312F));  // BT.601, full range
  const std::vector<double> inside = values_where(cr, patch.silhouette);
  if (inside.empty()) return 0;
  return *std::max_element(inside.begin(), inside.end()) - median_or_0(values_where(cr, around));
}

// Saturation and histogram of the silhouette.
void add_colour(const Patch& patch, Looks& looks) {
  double count = 0;
  for (int j = 0; j < patch.rgb.rows; ++j)
    for (int i = 0; i < patch.rgb.cols; ++i) {
      if (patch.silhouette.at<unsigned char>(j, i) == 0) continue;
      const auto p = patch.rgb.at<cv::Vec3b>(j, i);
      const auto [low, high] = std::minmax({p[0], p[1], p[2]});
      looks.saturation += high > 0 ? double(high - low) / high : 0;
      for (std::size_t c = 0; c < 3; ++c) looks.histogram[8 * c + p[static_cast<int>(c)] / 32] += 1;
      count += 1;
    }
  if (count == 0) return;
  looks.saturation /= count;
  for (double& bin : looks.histogram) bin /= 3 * count;
}

}  // namespace

Looks looks_of(const Patch& patch) {
  Looks looks;
  const auto kernel = cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3});
  cv::Mat inside, wide, around;
  cv::erode(patch.silhouette, inside, kernel);
  if (cv::countNonZero(inside) < 6) inside = patch.silhouette;
  cv::dilate(patch.silhouette, wide, kernel, {-1, -1}, 3);
  cv::bitwise_not(wide, around);
  looks.contrast = median_or_0(values_where(patch.grey, patch.silhouette)) -
                   median_or_0(values_where(patch.grey, around));
  const cv::Mat level = surroundings_of(patch.grey, around);
  add_contrast(patch.grey - level, patch.silhouette, looks);
  static_cast<Outline&>(looks) = outline_of(patch.grey, patch.silhouette, level);
  looks.noise = laplacian_deviation(patch.grey, inside);
  looks.background_noise = laplacian_deviation(patch.grey, around);
  looks.fine_share = share_above(patch.grey, 0.25);
  looks.middle_share = share_above(patch.grey, 0.125) - looks.fine_share;
  looks.blockiness = blockiness(patch.grey, patch.x);
  const cv::Moments moments = cv::moments(patch.silhouette, true);
  if (moments.m00 > 0)
    looks.centre_px = {patch.x + moments.m10 / moments.m00 + 0.5,
                       patch.y + moments.m01 / moments.m00 + 0.5};
  const cv::Rect bounds = cv::boundingRect(patch.silhouette);
  looks.longest_px = std::max(bounds.width, bounds.height);
  looks.brightest_decile = brightest_decile_of(values_where(patch.grey, patch.silhouette));
  looks.strongest_red = strongest_red_of(patch, around);
  add_colour(patch, looks);
  return looks;
}

double distance(const std::array<double, 24>& a, const std::array<double, 24>& b) {
  double overlap = 0;
  for (std::size_t i = 0; i < a.size(); ++i) overlap += std::sqrt(a[i] * b[i]);
  return std::sqrt(std::max(0.0, 1 - overlap));
}

}  // namespace airtruth::appearance
