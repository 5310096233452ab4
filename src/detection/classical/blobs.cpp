// SPDX-License-Identifier: Apache-2.0
#include "detection/classical/blobs.h"

#include <algorithm>
#include <array>
#include <cmath>

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
// An object that reaches further from its strongest sample, in samples of its level, is part of
// something else.
constexpr int kReach = 2 * kElement;
// Across, it may be as wide as the short element lets through, with what the smoothing adds.
constexpr int kMostAcross = kElement + 2;
// What belongs to the object differs by this share of its contrast: low enough for wings thinner
// than a sample, of which a third is left.
constexpr double kBoxShare = 0.3;
constexpr double kBoxNoise = 3;
// Of a response, which is not bounded on a finer level: half of it is left at a smoothed edge.
constexpr double kResponseShare = 0.5;
// Samples this far apart belong together: between a lit and a shaded part lies one that looks like
// the sky.
constexpr int kGap = 2;
// Standard deviation of normal noise over its median absolute deviation (Rousseeuw and Croux 1993).
constexpr double kSigmaOfMad = 1.4826;
// Noise is taken from the median deviation and from this quantile of it, whichever is more: clutter
// has long tails.
constexpr double kTailQuantile = 0.9;
constexpr double kSigmaOfTail = 1 / 1.6449;
// Closing and opening have noise of their own, which adds to that of the sample: its largest
// responses are as of this many times the noise (classical_test.cpp).
constexpr double kResponseNoise = 1.2;
// The rounding to whole grey levels, which makes patches that smoothing does not remove.
const double kLeastNoise = kGreyScale / std::sqrt(12.0);

// v(x, y) = middle + x * along_x + y * along_y around a sample.
struct Surroundings {
  double middle = 0, along_x = 0, along_y = 0;
  double noise = 0;
  double at(double x, double y) const { return middle + along_x * x + along_y * y; }
};

double median_of(std::vector<float>& values) {
  const auto half = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), half, values.end());
  return *half;
}

// The plane's slope is by least squares and its height by the median, which other objects in the
// ring do not lift. Samples within `object` do not count; of the others, every `stride`-th of every
// `stride`-th row.
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

// Bounds of the connected samples around a seed whose excess over the surroundings is at least
// `least`; empty where they reach beyond `reach` samples from the seed, or the picture's border.
class Region {
 public:
  Region(const Level& level, const cv::Point& seed, int reach)
      : level_(level), seed_(seed), reach_(reach), side_(2 * reach + 1) {}

  std::optional<cv::Rect> grown(const auto& excess, double least) {
    static thread_local std::vector<char> seen;
    static thread_local std::vector<cv::Point> open;
    seen.assign(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), 0);
    open.assign(1, seed_);
    mark(seen, seed_);
    cv::Point low = seed_, high = seed_;
    while (!open.empty()) {
      const cv::Point at = open.back();
      open.pop_back();
      low = {std::min(low.x, at.x), std::min(low.y, at.y)};
      high = {std::max(high.x, at.x), std::max(high.y, at.y)};
      for (int dy = -kGap; dy <= kGap; ++dy)
        for (int dx = -kGap; dx <= kGap; ++dx) {
          const cv::Point next{at.x + dx, at.y + dy};
          if (!is_inside(next)) continue;
          const bool is_beyond =
              std::max(std::abs(next.x - seed_.x), std::abs(next.y - seed_.y)) > reach_;
          // Each sample is looked at once.
          if (!is_beyond && !mark(seen, next)) continue;
          if (excess(next) < least) continue;
          if (is_beyond) return std::nullopt;
          open.push_back(next);
        }
    }
    return cv::Rect(low, high + cv::Point(1, 1));
  }

 private:
  bool is_inside(const cv::Point& p) const {
    return p.x >= 0 && p.y >= 0 && p.x < level_.picture.cols && p.y < level_.picture.rows &&
           !level_.hides(p);
  }
  // False where it was marked.
  bool mark(std::vector<char>& seen, const cv::Point& p) const {
    char& cell =
        seen[static_cast<std::size_t>(p.y - seed_.y + reach_) * static_cast<std::size_t>(side_) +
             static_cast<std::size_t>(p.x - seed_.x + reach_)];
    const bool is_new = cell == 0;
    cell = 1;
    return is_new;
  }

  const Level& level_;
  cv::Point seed_;
  int reach_;
  int side_;
};

Box box_of(const cv::Rect& samples, int step) {
  const double half = 0.5 * step;
  return {step * samples.x + 0.5 - half,
          step * samples.y + 0.5 - half,
          double(step) * samples.width,
          double(step) * samples.height};
}

// The samples of a level `finer` times coarser that the smoothing lets an object reach.
cv::Rect coarser(const cv::Rect& samples, int finer) {
  const cv::Point low{samples.x / finer - 1, samples.y / finer - 1};
  const cv::Point high{samples.br().x / finer + 2, samples.br().y / finer + 2};
  return {low, high};
}

// The sample of the finer level with the strongest excess under a sample of the coarser one.
cv::Point strongest_under(const Level& fine, const cv::Point& coarse, double sign) {
  cv::Point best{-1, -1};
  double most = -1e9;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const cv::Point p{2 * coarse.x + dx, 2 * coarse.y + dy};
      if (p.x < 0 || p.y < 0 || p.x >= fine.picture.cols || p.y >= fine.picture.rows) continue;
      const double value = sign * fine.picture.at<short>(p);
      if (value > most) {
        most = value;
        best = p;
      }
    }
  return best;
}

cv::Point strongest_in_block(const Level& level, int bx, int by) {
  const cv::Mat block = level.response({bx * kBlock, by * kBlock, kBlock, kBlock});
  cv::Point at;
  cv::minMaxLoc(block, nullptr, nullptr, nullptr, &at);
  return {bx * kBlock + at.x, by * kBlock + at.y};
}

// The object at a sample of a level against the ring around it: exact where that is a plane with
// noise. Empty where its samples reach too far.
std::optional<Blob> against_ring(const std::vector<Level>& levels,
                                 std::size_t number,
                                 const cv::Point& sample) {
  const Level& level = levels[number];
  auto around = surroundings_of(level, sample, {}, 2);
  if (!around) return std::nullopt;
  const double contrast = level.picture.at<short>(sample) - around->middle;
  const double sign = contrast < 0 ? -1 : 1;
  const double least = std::max(kBoxShare * std::abs(contrast),
                                std::min(0.5 * std::abs(contrast), kBoxNoise * around->noise));
  const bool has_finer = number > 0;
  const Level& fine = has_finer ? levels[number - 1] : level;
  const cv::Point seed = has_finer ? strongest_under(fine, sample, sign) : sample;
  const double scale = has_finer ? 0.5 : 1;
  const auto excess = [&](const cv::Point& p) {
    const double x = scale * p.x - sample.x, y = scale * p.y - sample.y;
    return std::abs(fine.picture.at<short>(p) - around->at(x, y));
  };
  const int finer = has_finer ? 2 : 1;
  const auto samples = Region(fine, seed, finer * kReach).grown(excess, least);
  if (!samples || std::min(samples->width, samples->height) > finer * kMostAcross)
    return std::nullopt;
  // Wings that reach across the ring are neither noise nor surroundings.
  around = surroundings_of(level, sample, coarser(*samples, finer), 1);
  if (!around) return std::nullopt;
  Blob blob;
  blob.box_px = box_of(*samples, fine.step);
  blob.contrast_to_noise = std::abs(level.picture.at<short>(sample) - around->middle) /
                           std::hypot(around->noise, level.clutter_at(sample));
  blob.against_ring = blob.contrast_to_noise;
  blob.is_dark = sign < 0;
  blob.level = number;
  blob.sample = sample;
  return blob;
}

// The object at a sample of a level against what closing or opening makes of its place, which
// follows the edges of clouds and fields: it is found where the ring is no plane.
std::optional<Blob> against_response(const Level& level,
                                     std::size_t number,
                                     const cv::Point& sample) {
  const double response = level.response.at<short>(sample);
  const double noise = level.noise_at(sample);
  const double contrast = response - Level::kMeanResponse * noise;
  if (contrast <= 0) return std::nullopt;
  const double least = std::max(kResponseShare * response, kBoxNoise * noise);
  const auto excess = [&](const cv::Point& p) { return double(level.response.at<short>(p)); };
  const auto samples = Region(level, sample, kReach).grown(excess, least);
  // A line from border to border ends at neither.
  const cv::Rect inner(kGap, kGap, level.picture.cols - 2 * kGap, level.picture.rows - 2 * kGap);
  if (!samples || (*samples & inner) != *samples ||
      std::min(samples->width, samples->height) > kMostAcross)
    return std::nullopt;
  Blob blob;
  blob.box_px = box_of(*samples, level.step);
  blob.contrast_to_noise = contrast / std::hypot(kResponseNoise * noise, level.clutter_at(sample));
  blob.level = number;
  blob.sample = sample;
  return blob;
}

}  // namespace

std::optional<Blob> blob_at(const std::vector<Level>& levels,
                            std::size_t number,
                            const cv::Point& sample) {
  const auto ring = against_ring(levels, number, sample);
  const auto response = against_response(levels[number], number, sample);
  if (!ring || !response) return ring ? ring : response;
  if (ring->contrast_to_noise >= response->contrast_to_noise) return ring;
  // The ring's box follows the finer level.
  Blob blob = *ring;
  blob.contrast_to_noise = response->contrast_to_noise;
  return blob;
}

bool is_same_object(const Box& a, const Box& b) {
  const double width = std::min(a.right(), b.right()) - std::max(a.x, b.x);
  const double height = std::min(a.bottom(), b.bottom()) - std::max(a.y, b.y);
  if (width <= 0 || height <= 0) return false;
  return width * height >= 0.5 * std::min(a.area(), b.area());
}

std::vector<Blob> blobs_of(const std::vector<Level>& levels, const BlobOptions& options) {
  std::vector<Blob> blobs;
  for (std::size_t number = 0; number < levels.size(); ++number) {
    const Level& level = levels[number];
    std::vector<std::pair<double, cv::Point>> blocks;
    for (int by = 0; by < level.largest.rows; ++by)
      for (int bx = 0; bx < level.largest.cols; ++bx) {
        const double largest = level.largest.at<short>(by, bx);
        const double typical = level.typical.at<float>(by, bx),
                     clutter = level.clutter.at<float>(by, bx);
        if (largest >= options.least_response * typical && level.is_peak(bx, by))
          blocks.push_back({-largest / std::hypot(typical, clutter), {bx, by}});
      }
    const auto order = [](const auto& a, const auto& b) {
      return std::tie(a.first, a.second.y, a.second.x) < std::tie(b.first, b.second.y, b.second.x);
    };
    std::sort(blocks.begin(), blocks.end(), order);
    if (blocks.size() > options.most_of_a_level) blocks.resize(options.most_of_a_level);
    for (const auto& [weight, block] : blocks)
      if (auto blob = blob_at(levels, number, strongest_in_block(level, block.x, block.y)))
        blobs.push_back(*blob);
  }
  std::stable_sort(blobs.begin(), blobs.end(), [](const Blob& a, const Blob& b) {
    return a.contrast_to_noise > b.contrast_to_noise;
  });
  return blobs;
}

}  // namespace airtruth::detection
