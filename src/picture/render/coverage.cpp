// SPDX-License-Identifier: Apache-2.0
#include "picture/render/coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "foundation/base/vectors.h"

namespace airtruth::render {
namespace {

constexpr float kPlaces = PixelLines::kPlaces;
constexpr std::uint32_t kFullMask = (1u << PixelLines::kPlaces) - 1;

// Where the sides of a triangle cut a line, in places from the pixel's border:
// at + per_across across + per_t t. The interval is above both of the first two and below both of
// the last two.
struct Cut {
  float at, per_across, per_t;
};
using Cuts = std::array<Cut, 4>;

struct LineBuffer {
  const PixelLines& lines;
  int from_block;
  int to_block;
  std::uint32_t* __restrict masks;
  std::uint64_t& full_blocks;
};

// The places in [low, high].
[[gnu::always_inline]] inline std::uint32_t mask_between(float low, float high) {
  low = low > 0 ? low : 0;
  low = low < kPlaces ? low : kPlaces;
  high = high < kPlaces - 1 ? high : kPlaces - 1;
  high = high > -1 ? high : -1;
  // Conversions round towards zero.
  const int first = PixelLines::kPlaces - static_cast<int>(kPlaces - low);
  const int end = static_cast<int>(high + 1);
  return end > first ? (1u << end) - (1u << first) : 0;
}

template <typename Interval>
[[gnu::always_inline]] inline void add_blocks(const LineBuffer& buffer, const Interval& interval) {
  for (int block = buffer.from_block; block < buffer.to_block; ++block) {
    if ((buffer.full_blocks >> block & 1u) != 0) continue;
    const int begin = block * PixelLines::kBlock;
    std::uint32_t all = kFullMask;
    for (int k = 0; k < PixelLines::kBlock; ++k) {
      const int i = begin + k;
      const std::array<float, 2> between = interval(i);
      const float offset = buffer.lines.offset[static_cast<std::size_t>(i)];
      const std::uint32_t mask =
          buffer.masks[i] | mask_between(between[0] - offset, between[1] - offset);
      buffer.masks[i] = mask;
      all &= mask;
    }
    if (all == kFullMask) buffer.full_blocks |= std::uint64_t{1} << block;
  }
}

AIRTRUTH_FOR_SHORT_VECTORS
void add_uniform(const Cuts& of, const LineBuffer& buffer) {
  const Cuts cuts = of;
  const float* __restrict across = buffer.lines.across.data();
  const float* __restrict t = buffer.lines.t.data();
  add_blocks(buffer, [&](int i) -> std::array<float, 2> {
    const auto at = [&](const Cut& cut) {
      return cut.at + (cut.per_across * across[i] + cut.per_t * t[i]);
    };
    const float low = at(cuts[0]);
    const float low2 = at(cuts[1]);
    const float high = at(cuts[2]);
    const float high2 = at(cuts[3]);
    return {low > low2 ? low : low2, high < high2 ? high : high2};
  });
}

// The functions where lines are along x; only the edges count.
AIRTRUTH_FOR_SHORT_VECTORS
void add_moving(const PixelFunctions& of, const LineBuffer& buffer) {
  const PixelFunctions f = of;
  const float* __restrict across = buffer.lines.across.data();
  const float* __restrict t = buffer.lines.t.data();
  add_blocks(buffer, [&](int i) -> std::array<float, 2> {
    float low = -1;
    float high = (t[i] >= f.begin_t) & (t[i] < f.end_t) ? kPlaces + 1 : -2.0f;
    for (int e = 0; e < 3; ++e) {
      const float rest = f.at[e] + t[i] * (f.per_t[e] + f.per_tt[e] * t[i]) +
                         across[i] * (f.per_y[e] + f.per_yt[e] * t[i]);
      float slope = f.per_x[e] + f.per_xt[e] * t[i];
      slope = slope == 0 ? std::numeric_limits<float>::min() : slope;
      const float cut = kPlaces * (0.5f - rest / slope);
      low = (slope > 0) & (cut > low) ? cut : low;
      high = (slope < 0) & (cut < high) ? cut : high;
    }
    return {low, high};
  });
}

// False where the three edges are not one or two below and as many above.
bool find_cuts(const PixelFunctions& f, Cuts& cuts) {
  // An edge along the lines cuts them far away: this much of its other terms is the least slope.
  constexpr float kLeastSlope = 1e-6f;
  cuts[0] = cuts[1] = {-1, 0, 0};
  cuts[2] = cuts[3] = {kPlaces + 1, 0, 0};
  std::size_t below = 0;
  std::size_t above = 2;
  for (int e = 0; e < 3; ++e) {
    const float least = kLeastSlope * (std::abs(f.at[e]) + std::abs(f.per_y[e]) +
                                       std::abs(f.per_t[e]) + std::abs(f.per_x[e]));
    float slope = f.per_x[e];
    if (std::abs(slope) < least) slope = std::copysign(least, slope);
    if (slope == 0) return false;
    const float scale = -kPlaces / slope;
    std::size_t& next = slope > 0 ? below : above;
    if (next == (slope > 0 ? 2U : 4U)) return false;
    cuts[next++] = {0.5f * kPlaces + scale * f.at[e], scale * f.per_y[e], scale * f.per_t[e]};
  }
  return true;
}

}  // namespace

PixelLines::PixelLines(int lines, bool by_time) : count(lines) {
  // Steps of sequences of low discrepancy (Roberts 2018: the powers of the inverse golden ratio's
  // like in two dimensions).
  constexpr double kFirstStep = 0.75487766624669276;
  constexpr double kSecondStep = 0.56984029099805327;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const double key = (static_cast<double>(i) + 0.5) / count;
    const double other = std::fmod(0.5 + kFirstStep * static_cast<double>(i), 1.0);
    across[i] = static_cast<float>((by_time ? other : key) - 0.5);
    t[i] = by_time ? static_cast<float>(2 * key - 1) : 0;
    offset[i] = static_cast<float>(std::fmod(0.5 + kSecondStep * static_cast<double>(i), 1.0));
  }
}

void CoverageMasks::add(const PixelFunctions& functions, float from, float to) {
  const auto blocks = static_cast<float>(lines_->count) / PixelLines::kBlock;
  const LineBuffer buffer{*lines_,
                      static_cast<int>(std::clamp(from * blocks, 0.0f, blocks)),
                      static_cast<int>(std::ceil(std::clamp(to * blocks, 0.0f, blocks))),
                      masks_.data(),
                      full_blocks_};
  PixelFunctions f = functions;
  if (along_y_) {
    std::swap(f.per_x, f.per_y);
    std::swap(f.per_xt, f.per_yt);
  }
  Cuts cuts;
  if (f.is_uniform() && find_cuts(f, cuts))
    add_uniform(cuts, buffer);
  else
    add_moving(f, buffer);
}

}  // namespace airtruth::render
