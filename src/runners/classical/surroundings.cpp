// SPDX-License-Identifier: Apache-2.0
#include "runners/classical/surroundings.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace airtruth::classical {
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

// The median of the response and its kTailQuantile, over the noise of the picture, on level 0
// (blobs_test.cpp repeats it). The long elements of the others make both a little larger, which is
// on the safe side.
constexpr double kMedianOfResponse = 0.65;
constexpr double kTailOfResponse = 1.6;

double quantile_of(std::vector<float>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

bool is_ring_enough(std::size_t samples, int stride) {
  return static_cast<double>(samples) * stride * stride >= kLeastRing * kWholeRing;
}

// Calls with each sample of the ring and where it lies from the centre.
void for_ring(const Level& level,
              const cv::Point& centre,
              const cv::Rect& object,
              int stride,
              const auto& use) {
  for (int dy = -kRingTo; dy <= kRingTo; dy += stride) {
    const int y = centre.y + dy;
    if (y < 0 || y >= level.picture.rows) continue;
    const bool crosses = std::abs(dy) < kRingFrom;
    for (int dx = -kRingTo; dx <= kRingTo; dx += stride) {
      if (crosses && std::abs(dx) < kRingFrom) continue;
      const cv::Point sample{centre.x + dx, y};
      if (sample.x < 0 || sample.x >= level.picture.cols || object.contains(sample) ||
          level.hides(sample))
        continue;
      use(sample, cv::Point(dx, dy));
    }
  }
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
  double sum_x = 0, sum_y = 0, sum_v = 0;
  for_ring(level, centre, object, stride, [&](const cv::Point& sample, const cv::Point& place) {
    const short value = level.picture.at<short>(sample);
    values.push_back(value);
    places.push_back(place);
    sum_x += place.x;
    sum_y += place.y;
    sum_v += value;
  });
  if (!is_ring_enough(values.size(), stride)) return std::nullopt;
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
  around.middle = quantile_of(values, 0.5);
  for (float& value : values) value = std::abs(value - static_cast<float>(around.middle));
  const double median = quantile_of(values, 0.5);
  const double tail = quantile_of(values, kTailQuantile);
  around.noise = std::max({kLeastNoise, kSigmaOfMad * median, kSigmaOfTail * tail});
  return around;
}

std::optional<double> noise_of_responses(const Level& level,
                                         const cv::Point& centre,
                                         const cv::Rect& object) {
  static thread_local std::vector<float> values;
  values.clear();
  for_ring(level, centre, object, 1, [&](const cv::Point& sample, const cv::Point&) {
    values.push_back(level.response.at<short>(sample));
  });
  if (!is_ring_enough(values.size(), 1)) return std::nullopt;
  const double median = quantile_of(values, 0.5);
  return std::max(median / kMedianOfResponse, quantile_of(values, kTailQuantile) / kTailOfResponse);
}

}  // namespace airtruth::classical
