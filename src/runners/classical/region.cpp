// SPDX-License-Identifier: Apache-2.0
#include "runners/classical/region.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "foundation/base/median.h"

namespace airtruth::classical {
namespace {

// Where a constant of this file states no origin, it is a choice; docs/detection.md has the result.

// An object has at least a pixel.
constexpr double kLeastBoxSidePx = 1;
// Each halves the interval, which begins at an object's blurred side: to less than a hundredth.
constexpr int kHalvings = 8;

struct Grower {
  const Level& level;
  cv::Point seed;
  int reach;
  const Excess& excess;
  double least;
  // Memory that one region after the other uses.
  std::vector<char>& seen;
  std::vector<cv::Point>& open;
  bool hides = !level.hidden.empty();
  double most = 0;
  Region region = {};

  std::optional<Region> grown() {
    seen.assign(static_cast<std::size_t>(side() * side()), 0);
    open.assign(1, seed);
    mark(seed);
    region = {{}, double(seed.x), double(seed.y), double(seed.x), double(seed.y)};
    cv::Point low = seed, high = seed;
    while (!open.empty()) {
      const cv::Point at = open.back();
      open.pop_back();
      low = {std::min(low.x, at.x), std::min(low.y, at.y)};
      high = {std::max(high.x, at.x), std::max(high.y, at.y)};
      bound(at);
      if (is_all_within(at))
        take_all_around(at);
      else if (!take_around(at))
        return std::nullopt;
    }
    region.samples = cv::Rect(low, high + cv::Point(1, 1));
    region.share = most > least ? least / most : 1;
    return region;
  }

  // Takes what belongs to the region of the samples around one. False where that is out of reach.
  bool take_around(const cv::Point& at) {
    for (int dy = -kGap; dy <= kGap; ++dy)
      for (int dx = -kGap; dx <= kGap; ++dx) {
        const cv::Point next{at.x + dx, at.y + dy};
        if (!is_inside(next)) continue;
        // Each sample is looked at once.
        if (is_within_reach(next) && !mark(next)) continue;
        if (excess(next) < least) continue;
        if (!is_within_reach(next)) return false;
        open.push_back(next);
      }
    return true;
  }
  // The same where all samples around are in reach and in the picture, which is most of the work.
  void take_all_around(const cv::Point& at) {
    for (int dy = -kGap; dy <= kGap; ++dy) {
      char* is_seen = &cell({at.x - kGap, at.y + dy});
      for (int dx = -kGap; dx <= kGap; ++dx, ++is_seen) {
        if (*is_seen != 0) continue;
        *is_seen = 1;
        const cv::Point next{at.x + dx, at.y + dy};
        if (excess(next) >= least && !(hides && level.hides(next))) open.push_back(next);
      }
    }
  }
  bool is_all_within(const cv::Point& p) const {
    return std::max(std::abs(p.x - seed.x), std::abs(p.y - seed.y)) + kGap <= reach &&
           p.x >= kGap && p.y >= kGap && p.x + kGap < level.picture.cols &&
           p.y + kGap < level.picture.rows;
  }
  bool is_inside(const cv::Point& p) const {
    return p.x >= 0 && p.y >= 0 && p.x < level.picture.cols && p.y < level.picture.rows &&
           !(hides && level.hides(p));
  }
  bool is_within_reach(const cv::Point& p) const {
    return std::max(std::abs(p.x - seed.x), std::abs(p.y - seed.y)) <= reach;
  }
  // False where it was marked.
  bool mark(const cv::Point& p) { return std::exchange(cell(p), char{1}) == 0; }
  int side() const { return 2 * reach + 1; }
  char& cell(const cv::Point& p) {
    return seen[static_cast<std::size_t>(p.y - seed.y + reach) * static_cast<std::size_t>(side()) +
                static_cast<std::size_t>(p.x - seed.x + reach)];
  }

  // The bounds reach as far as the excess does between this sample and its neighbours.
  void bound(const cv::Point& p) {
    const double here = excess(p);
    most = std::max(most, here);
    const auto reached = [&](int dx, int dy) {
      const cv::Point next{p.x + dx, p.y + dy};
      if (!is_inside(next)) return 0.5;
      const double there = excess(next);
      return here > least && there < least ? (here - least) / (here - there) : 0.0;
    };
    if (p.x - 1 < region.left) region.left = std::min(region.left, p.x - reached(-1, 0));
    if (p.y - 1 < region.top) region.top = std::min(region.top, p.y - reached(0, -1));
    if (p.x + 1 > region.right) region.right = std::max(region.right, p.x + reached(1, 0));
    if (p.y + 1 > region.bottom) region.bottom = std::max(region.bottom, p.y + reached(0, 1));
  }
};

double normal_below(double deviations) { return 0.5 * std::erfc(-deviations / std::sqrt(2.0)); }

// The variance of [1 2 1] / 4 is half a squared sample; octave by octave it adds up to
// (1 + 4 + ... + step^2) / 2.
double blur_sigma_px(int step) { return std::sqrt((4.0 * step * step - 1) / 6); }

}  // namespace

std::optional<Region> region_around(
    const Level& level, const cv::Point& seed, int reach, const Excess& excess, double least) {
  static thread_local std::vector<char> seen;
  static thread_local std::vector<cv::Point> open;
  return Grower{level, seed, reach, excess, least, seen, open}.grown();
}

double side_before_blur(double half_px, double share, double sigma_px) {
  const double half = half_px / sigma_px;
  if (std::exp(-0.5 * half * half) >= share) return 0;
  // Of a share of more than a half, the side is the longer one, by less than this.
  double low = 0, high = 2 * half + 4;
  for (int halving = 0; halving < kHalvings; ++halving) {
    const double side = (low + high) / 2;
    const double left = normal_below(half + side / 2) - normal_below(half - side / 2);
    (left < share * (2 * normal_below(side / 2) - 1) ? low : high) = side;
  }
  return (low + high) / 2 * sigma_px;
}

Box box_of(const Region& region, const Level& level) {
  const double sigma_px = blur_sigma_px(level.step);
  const auto side = [&](double from, double to) {
    const double half_px = 0.5 * level.step * (to - from);
    return std::max(kLeastBoxSidePx, side_before_blur(half_px, region.share, sigma_px));
  };
  const Pixel middle =
      level.pixel_of((region.left + region.right) / 2, (region.top + region.bottom) / 2);
  const double width = side(region.left, region.right);
  const double height = side(region.top, region.bottom);
  return {middle.x() - width / 2, middle.y() - height / 2, width, height};
}

namespace {

// Half sides of the ring around an object, in samples of its level: from beyond what the elements
// let through to as much again.
constexpr int kRingFrom = kElement;
constexpr int kRingTo = 2 * kElement - 2;
// At the picture's border, a ring with less than this share of its samples tells too little.
constexpr double kLeastRing = 0.5;
constexpr int kWholeRing =
    (2 * kRingTo + 1) * (2 * kRingTo + 1) - (2 * kRingFrom - 1) * (2 * kRingFrom - 1);
// Noise is taken from the median deviation and from this quantile of it, whichever is more: clutter
// has long tails.
constexpr double kTailQuantile = 0.9;
// Standard deviation of normal noise over that quantile of its absolute deviation.
constexpr double kSigmaOfTail = 1 / 1.6449;
// The rounding to whole grey levels, which makes patches that smoothing does not remove.
const double kLeastNoise = kGreyScale / std::sqrt(12.0);

// The median of the response and its kTailQuantile, over the noise of the picture, on level 0
// (blobs_test.cpp repeats it). The long elements of the others make both a little larger, which is
// on the safe side.
constexpr double kMedianOfResponse = 0.65;
constexpr double kTailOfResponse = 1.6;

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
  around.middle = quantile(values, 0.5);
  for (float& value : values) value = std::abs(value - static_cast<float>(around.middle));
  const double median = quantile(values, 0.5);
  const double tail = quantile(values, kTailQuantile);
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
  const double median = quantile(values, 0.5);
  return std::max(median / kMedianOfResponse, quantile(values, kTailQuantile) / kTailOfResponse);
}

}  // namespace airtruth::classical
