// SPDX-License-Identifier: Apache-2.0
#include "detection/classical/surroundings.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace airtruth::detection {
namespace {

// Half sides of the ring around an object, in samples of its level: from beyond what the elements
// let through to as much again.
constexpr int kRingFrom = kElement;
constexpr int kRingTo = 2 * kElement - 2;
// At the picture's border, a ring with less than this share of its samples tells too little.
constexpr double kLeastRing = 0.6;
constexpr int kWholeRing =
    (2 * kRingTo + 1) * (2 * kRingTo + 1) - (2 * kRingFrom - 1) * (2 * kRingFrom - 1);
// Standard deviation of normal noise over its median absolute deviation (Rousseeuw and Croux 1993).
constexpr double kSigmaOfMad = 1.4826;
// Noise is taken from the median deviation and from this quantile of it, whichever is more: clutter
// has long tails.
constexpr double kTailQuantile = 0.9;
constexpr double kSigmaOfTail = 1 / 1.6449;
// The rounding to whole grey levels, which makes patches that smoothing does not remove.
const double kLeastNoise = kGreyScale / std::sqrt(12.0);

double median_of(std::vector<float>& values) {
  const auto half = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), half, values.end());
  return *half;
}

}  // namespace

std::optional<Surroundings> surroundings_of(const Level& level,
                                            const cv::Point& centre,
                                            const cv::Rect& object,
                                            int stride) {
  static thread_local std::vector<float> values;
  static thread_local std::vector<cv::Point> places;
  values.clear();
  places.clear();
  const cv::Mat& picture = level.picture;
  double sum_x = 0, sum_y = 0, sum_v = 0;
  for (int dy = -kRingTo; dy <= kRingTo; dy += stride) {
    const int y = centre.y + dy;
    if (y < 0 || y >= picture.rows) continue;
    const short* row = picture.ptr<short>(y);
    const bool crosses = std::abs(dy) < kRingFrom;
    for (int dx = -kRingTo; dx <= kRingTo; dx += stride) {
      if (crosses && std::abs(dx) < kRingFrom) continue;
      const int x = centre.x + dx;
      if (x < 0 || x >= picture.cols || object.contains({x, y}) || level.hides({x, y})) continue;
      values.push_back(row[x]);
      places.push_back({dx, dy});
      sum_x += dx;
      sum_y += dy;
      sum_v += row[x];
    }
  }
  if (static_cast<double>(values.size()) * stride * stride < kLeastRing * kWholeRing)
    return std::nullopt;
  const double n = static_cast<double>(values.size());
  double xx = 0, yy = 0, xy = 0, xv = 0, yv = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = places[i].x - sum_x / n, y = places[i].y - sum_y / n;
    const double v = values[i] - sum_v / n;
    xx += x * x;
    yy += y * y;
    xy += x * y;
    xv += x * v;
    yv += y * v;
  }
  Surroundings around;
  if (const double det = xx * yy - xy * xy; det > 0) {
    around.along_x = (xv * yy - yv * xy) / det;
    around.along_y = (yv * xx - xv * xy) / det;
  }
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] -= static_cast<float>(around.along_x * places[i].x + around.along_y * places[i].y);
  around.middle = median_of(values);
  for (float& value : values) value = std::abs(value - static_cast<float>(around.middle));
  const double mad = median_of(values);
  const auto tail = values.begin() + static_cast<std::ptrdiff_t>(kTailQuantile * n);
  std::nth_element(values.begin(), tail, values.end());
  around.noise = std::max({kLeastNoise, kSigmaOfMad * mad, kSigmaOfTail * *tail});
  return around;
}

}  // namespace airtruth::detection
