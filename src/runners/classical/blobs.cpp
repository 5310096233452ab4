// SPDX-License-Identifier: Apache-2.0
#include "runners/classical/blobs.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

#include "runners/classical/region.h"

namespace airtruth::classical {
namespace {

// Where a constant of this file states no origin, it is a choice; docs/detection.md has the result.

// An object that reaches further from its strongest sample, in samples of its level, is part of
// something else.
constexpr int kReach = 2 * kElement;
// Across, in samples, it may be as wide as the short element lets through, with what the smoothing
// adds.
constexpr int kMostAcross = kElement + 2;
// What belongs to the object differs by this share of its contrast: low enough for wings thinner
// than a sample, of which a third is left.
constexpr double kBoxShare = 0.3;
// What surely does, as a share of it.
constexpr double kCoreShare = 0.5;
// Where the noise allows it and the object stays bounded, by this share: a wing in shade has a
// tenth of the contrast of a sunlit fuselage.
constexpr double kFaintShare = 0.1;
// Of some 200 samples around an object, noise exceeds three standard deviations in every other
// object, and four in one of a hundred.
constexpr double kFaintNoise = 4;
constexpr double kBoxNoise = 3;
// What belongs to an object that responds, which is not bounded on a finer level: half of the
// response is left at a smoothed edge.
constexpr double kResponseShare = 0.5;
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
  const cv::Rect block = block_in(level.response.size(), bx, by);
  cv::Point at;
  cv::minMaxLoc(level.response(block), nullptr, nullptr, nullptr, &at);
  return block.tl() + at;
}

// A sample of a level against the plane of the ring around it. The object's samples are those of
// the next finer level, where there is one.
struct AgainstRing {
  const Level& level;
  const Level& fine;
  int finer;  // samples of `fine` along one of `level`
  cv::Point sample, seed;
  Surroundings around;
  double contrast;

  // The connected samples whose excess is at least so much; empty where they reach too far.
  std::optional<Region> bounded(double least) const {
    const auto excess = [&](const cv::Point& p) {
      const double x = double(p.x) / finer - sample.x, y = double(p.y) / finer - sample.y;
      return std::abs(fine.picture.at<short>(p) - around.at(x, y));
    };
    auto region = region_around(fine, seed, finer * kReach, excess, least);
    if (region && std::min(region->samples.width, region->samples.height) > finer * kMostAcross)
      region.reset();
    return region;
  }
  double share(double of_contrast) const { return of_contrast * std::abs(contrast); }
  double usual() const {
    return std::max(share(kBoxShare), std::min(share(kCoreShare), kBoxNoise * around.noise));
  }
  double faint() const {
    return std::max(share(kFaintShare), kFaintNoise * std::max(around.noise, fine.noise_at(seed)));
  }
};

std::optional<AgainstRing> against_ring(const std::vector<Level>& levels,
                                        std::size_t number,
                                        const cv::Point& sample) {
  const Level& level = levels[number];
  const auto around = surroundings_of(level, sample, {}, 2);
  if (!around) return std::nullopt;
  const double contrast = level.picture.at<short>(sample) - around->middle;
  if (number == 0) return AgainstRing{level, level, 1, sample, sample, *around, contrast};
  const Level& fine = levels[number - 1];
  const cv::Point seed = strongest_under(fine, sample, contrast < 0 ? -1 : 1);
  return AgainstRing{level, fine, 2, sample, seed, *around, contrast};
}

// The object against the ring: exact where that is a plane with noise.
std::optional<Blob> blob_of(const AgainstRing& ring, const Region& region, std::size_t number) {
  const Level& level = ring.level;
  // Wings that reach across the ring are neither noise nor surroundings.
  const auto around = surroundings_of(level, ring.sample, coarser(region.samples, ring.finer), 1);
  if (!around) return std::nullopt;
  const double to_noise =
      std::abs(level.picture.at<short>(ring.sample) - around->middle) / around->noise;
  return Blob{box_of(region, ring.fine), to_noise, to_noise, number, ring.sample};
}

// The connected samples that are as dark (or bright) as a sample that responds, to half of its
// response. An object must end in the picture: the top of a pole responds, and is part of the pole.
// A line from border to border ends at neither.
std::optional<Region> responding_region(const Level& level, const cv::Point& sample, double noise) {
  const double response = level.response.at<short>(sample);
  const double sign = level.is_dark.at<std::uint8_t>(sample) != 0 ? -1 : 1;
  const double without = level.picture.at<short>(sample) - sign * response;
  const auto excess = [&](const cv::Point& p) {
    return sign * (level.picture.at<short>(p) - without);
  };
  const double least = std::max(kResponseShare * response, kBoxNoise * noise);
  auto region = region_around(level, sample, kReach, excess, least);
  const cv::Rect inner(kGap, kGap, level.picture.cols - 2 * kGap, level.picture.rows - 2 * kGap);
  if (!region || (region->samples & inner) != region->samples ||
      std::min(region->samples.width, region->samples.height) > kMostAcross)
    return std::nullopt;
  return region;
}

double response_to_noise(const Level& level, const cv::Point& sample, double noise) {
  const double contrast = level.response.at<short>(sample) - Level::kMeanResponse * noise;
  return contrast / std::hypot(Level::kLargestResponses * noise, level.clutter_at(sample));
}

// The object at a sample of a level against what closing or opening makes of its place, which
// follows the edges of clouds and fields: it is found where the ring is no plane. Its noise is that
// of the responses in the same ring, or the typical one if that is more, and the clutter. Empty
// where its score is not above `least`.
std::optional<Blob> against_response(const Level& level,
                                     std::size_t number,
                                     const cv::Point& sample,
                                     double least) {
  const double typical = level.noise_at(sample);
  if (response_to_noise(level, sample, typical) <= least) return std::nullopt;
  const auto region = responding_region(level, sample, typical);
  if (!region) return std::nullopt;
  const cv::Point margin(kGap, kGap);
  const cv::Rect own(region->samples.tl() - margin, region->samples.br() + margin);
  const auto noise = noise_of_responses(level, sample, own);
  if (!noise) return std::nullopt;
  const double to_noise = response_to_noise(level, sample, std::max(typical, *noise));
  if (to_noise <= least) return std::nullopt;
  return Blob{box_of(*region, level), to_noise, 0, number, sample};
}

// The object by its parts, within the one of its bounds that holds them best. Those by the ring are
// at hand; what is bounded without having parts of its own is left to the other measures.
std::optional<Blob> by_parts(const std::vector<Level>& levels,
                             std::size_t number,
                             const cv::Point& sample,
                             const AgainstRing* ring,
                             const std::vector<Region>& by_ring) {
  const Level& level = levels[number];
  std::vector<Box> boxes;
  for (const Region& region : by_ring) boxes.push_back(box_of(region, ring->fine));
  const auto is_short = [](const Box& box) {
    return std::max(box.width, box.height) <= kLongElement;
  };
  if (!boxes.empty() && std::all_of(boxes.begin(), boxes.end(), is_short)) return std::nullopt;
  if (const auto core = ring ? ring->bounded(ring->share(kCoreShare)) : std::nullopt)
    boxes.push_back(box_of(*core, ring->fine));
  if (const auto region = responding_region(level, sample, level.noise_at(sample)))
    boxes.push_back(box_of(*region, level));
  const auto whole = whole_of_parts(levels, number, boxes);
  if (!whole) return std::nullopt;
  return Blob{whole->box_px, whole->to_noise, whole->to_noise, number, sample};
}

}  // namespace

std::optional<Blob> blob_at(const std::vector<Level>& levels,
                            std::size_t number,
                            const cv::Point& sample) {
  const Level& level = levels[number];
  const auto ring = against_ring(levels, number, sample);
  // The widest bounds first.
  std::vector<Region> bounds;
  const auto bound = [&](double least_excess) {
    if (auto region = ring->bounded(least_excess)) bounds.push_back(*region);
  };
  if (ring && ring->faint() < ring->usual()) bound(ring->faint());
  if (ring && (bounds.empty() || number >= kPartOctaves)) bound(ring->usual());
  std::optional<Blob> blob;
  if (!bounds.empty()) blob = blob_of(*ring, bounds.front(), number);
  const double least = blob ? blob->contrast_to_noise : 0;
  if (const auto response = against_response(level, number, sample, least)) {
    // The ring's box follows the finer level.
    if (!blob) blob = response;
    blob->contrast_to_noise = response->contrast_to_noise;
  }
  if (number < kPartOctaves) return blob;
  const auto whole = by_parts(levels, number, sample, ring ? &*ring : nullptr, bounds);
  return whole && whole->contrast_to_noise > (blob ? blob->contrast_to_noise : 0) ? whole : blob;
}

bool is_same_object(const Box& a, const Box& b) {
  const auto common = intersection(a, b);
  return common && common->area() >= 0.5 * std::min(a.area(), b.area());
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
    std::ranges::sort(blocks, {}, [](const auto& one) {
      return std::tuple(one.first, one.second.y, one.second.x);
    });
    if (blocks.size() > options.most_of_a_level) blocks.resize(options.most_of_a_level);
    for (const auto& [weight, block] : blocks)
      if (auto blob = blob_at(levels, number, strongest_in_block(level, block.x, block.y)))
        blobs.push_back(*blob);
  }
  std::ranges::stable_sort(blobs, std::greater(), &Blob::contrast_to_noise);
  return blobs;
}

namespace {

// Blocks between a box and its ring, which the long element and the smoothing reach into.
constexpr int kGuardBlocks = 2;
// The ring is as wide as half of the box and not less than this.
constexpr int kLeastRingBlocks = 4;
// At the picture's border, a ring with less than this share of its blocks tells too little.
constexpr double kLeastShareOfRing = 0.6;
cv::Rect grown(const cv::Rect& blocks, int by) {
  return {blocks.x - by, blocks.y - by, blocks.width + 2 * by, blocks.height + 2 * by};
}

// The blocks that a box reaches into; empty where it is not longer than the elements.
cv::Rect blocks_of(const Level& level, const Box& box_px) {
  const cv::Point low = level.sample_at({box_px.x, box_px.y});
  const cv::Point high = level.sample_at({box_px.right(), box_px.bottom()});
  const cv::Rect samples =
      cv::Rect(low, high + cv::Point(1, 1)) & cv::Rect({}, level.response.size());
  if (std::max(samples.width, samples.height) <= kLongElement) return {};
  const cv::Rect blocks(samples.tl() / kBlock,
                        (samples.br() - cv::Point(1, 1)) / kBlock + cv::Point(1, 1));
  return blocks & cv::Rect({}, level.largest.size());
}

// The noise of the picture that makes the responses in the ring; empty where too few of its blocks
// lie in the picture.
std::optional<double> noise_around(const Level& level, const cv::Rect& blocks) {
  const cv::Rect all({}, level.largest.size());
  const cv::Rect inner = grown(blocks, kGuardBlocks);
  const int width = std::max(kLeastRingBlocks, std::max(blocks.width, blocks.height) / 2);
  const cv::Rect outer = grown(inner, width);
  const cv::Rect seen_inner = inner & all, seen_outer = outer & all;
  const int seen = seen_outer.area() - seen_inner.area();
  if (seen < kLeastShareOfRing * (outer.area() - inner.area())) return std::nullopt;
  const double squares =
      sum_within(level.largest_squares, seen_outer) - sum_within(level.largest_squares, seen_inner);
  const double least = Level::quietest() / Level::kMeanResponse;
  return std::max(least, std::sqrt(squares / seen) / kLargestOfBlock);
}

}  // namespace

std::optional<Parts> parts_within(const Level& level, const Box& box_px) {
  const cv::Rect blocks = blocks_of(level, box_px);
  if (blocks.empty()) return std::nullopt;
  const auto noise = noise_around(level, blocks);
  if (!noise) return std::nullopt;
  const double response = std::sqrt(sum_within(level.largest_squares, blocks) / blocks.area());
  Parts parts;
  parts.to_noise = (response / *noise - Level::kMeanResponse) / Level::kLargestResponses;
  const double ratio = std::max(1.0, std::pow(response / (kLargestOfBlock * *noise), 2));
  parts.log_ratio = 0.5 * blocks.area() * (ratio - 1 - std::log(ratio));
  return parts;
}

std::optional<Whole> whole_of_parts(const std::vector<Level>& levels,
                                    std::size_t level,
                                    const std::vector<Box>& boxes_px) {
  std::optional<Whole> best;
  double most = 0;
  for (const Box& box : boxes_px) {
    Whole whole{box, 0};
    double log_ratio = 0;
    for (std::size_t finer = 0; finer + kPartOctaves <= level; ++finer) {
      const auto parts = parts_within(levels[finer], box);
      if (!parts) continue;
      whole.to_noise = std::max(whole.to_noise, parts->to_noise);
      log_ratio += parts->log_ratio;
    }
    if (log_ratio <= most) continue;
    most = log_ratio;
    best = whole;
  }
  return best;
}

}  // namespace airtruth::classical
