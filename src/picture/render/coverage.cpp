// SPDX-License-Identifier: Apache-2.0
#include "picture/render/coverage.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "foundation/base/vectors.h"

namespace airtruth::render {
namespace {

// Number of places of a line, and the mask in which all are covered.
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

// The numbers of a block of lines. Compilers do not find these vectors by themselves in loops that
// shift by a variable.
using Floats [[gnu::vector_size(4 * PixelLines::kBlock)]] = float;
using Ints [[gnu::vector_size(4 * PixelLines::kBlock)]] = std::int32_t;
using Masks [[gnu::vector_size(4 * PixelLines::kBlock)]] = std::uint32_t;

// A function that returned them would have another binary interface for each instruction set.
[[gnu::always_inline]] inline void load(const float* from, Floats& to) {
  std::memcpy(&to, from, sizeof(to));
}

// Adds the places in [low, high] of each line of a block.
[[gnu::always_inline]] inline void add_between(const LineBuffer& buffer,
                                               int block,
                                               Floats& low,
                                               Floats& high) {
  const int begin = block * PixelLines::kBlock;
  Floats offset;
  load(buffer.lines.offset.data() + begin, offset);
  const Floats none = Floats{};
  low -= offset;
  high -= offset;
  low = low > 0.0f ? low : none;
  low = low < kPlaces ? low : none + kPlaces;
  high = high < kPlaces - 1 ? high : none + (kPlaces - 1);
  high = high > -1.0f ? high : none - 1.0f;
  // Conversions round towards zero.
  const Ints first = PixelLines::kPlaces - __builtin_convertvector(kPlaces - low, Ints);
  const Ints end = __builtin_convertvector(high + 1.0f, Ints);
  const Masks one = Masks{} + 1u;
  const Masks between =
      (one << __builtin_convertvector(end, Masks)) - (one << __builtin_convertvector(first, Masks));
  Masks masks;
  std::memcpy(&masks, buffer.masks + begin, sizeof(masks));
  masks |= between & __builtin_convertvector(end > first, Masks);
  std::memcpy(buffer.masks + begin, &masks, sizeof(masks));
  std::array<std::uint64_t, sizeof(masks) / 8> pairs;
  std::memcpy(pairs.data(), &masks, sizeof(masks));
  constexpr std::uint64_t kFullPair = std::uint64_t{kFullMask} << 32 | kFullMask;
  if ((pairs[0] & pairs[1] & pairs[2] & pairs[3]) == kFullPair)
    buffer.full_blocks |= std::uint64_t{1} << block;
}

AIRTRUTH_FOR_SHORT_VECTORS
void add_uniform(const Cuts& of, const LineBuffer& buffer) {
  const Cuts cuts = of;
  for (int block = buffer.from_block; block < buffer.to_block; ++block) {
    if ((buffer.full_blocks >> block & 1u) != 0) continue;
    const int begin = block * PixelLines::kBlock;
    Floats across, t;
    load(buffer.lines.across.data() + begin, across);
    load(buffer.lines.t.data() + begin, t);
    std::array<Floats, 4> at;
    for (std::size_t k = 0; k < 4; ++k)
      at[k] = cuts[k].at + (cuts[k].per_across * across + cuts[k].per_t * t);
    Floats low = at[0] > at[1] ? at[0] : at[1];
    Floats high = at[2] < at[3] ? at[2] : at[3];
    add_between(buffer, block, low, high);
  }
}

// The functions where lines are along x; only the edges count.
AIRTRUTH_FOR_SHORT_VECTORS
void add_moving(const PixelFunctions& of, const LineBuffer& buffer) {
  const PixelFunctions f = of;
  for (int block = buffer.from_block; block < buffer.to_block; ++block) {
    if ((buffer.full_blocks >> block & 1u) != 0) continue;
    const int begin = block * PixelLines::kBlock;
    Floats across, t;
    load(buffer.lines.across.data() + begin, across);
    load(buffer.lines.t.data() + begin, t);
    const Floats none = Floats{};
    Floats low = none - 1.0f;
    const Ints holds = (t >= f.begin_t) & (t < f.end_t);
    Floats high = holds ? none + (kPlaces + 1) : none - 2.0f;
    for (int e = 0; e < 3; ++e) {
      const Floats rest =
          f.at[e] + t * (f.per_t[e] + f.per_tt[e] * t) + across * (f.per_y[e] + f.per_yt[e] * t);
      Floats slope = f.per_x[e] + f.per_xt[e] * t;
      slope = slope == 0.0f ? none + std::numeric_limits<float>::min() : slope;
      const Floats cut = kPlaces * (0.5f - rest / slope);
      const Ints raises = (slope > 0.0f) & (cut > low);
      const Ints lowers = (slope < 0.0f) & (cut < high);
      low = raises ? cut : low;
      high = lowers ? cut : high;
    }
    add_between(buffer, block, low, high);
  }
}

// False where the three edges are not one or two below and as many above.
bool find_cuts(const PixelFunctions& f, Cuts& cuts) {
  // An edge along the lines cuts them far away: this share of its other terms is the least slope.
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

PixelFunctions functions_over(const RayTriangle& triangle,
                              const PixelRay& ray,
                              float u,
                              float half_u) {
  PixelFunctions f;
  std::array<Eigen::Array4f, 3> now;
  for (std::size_t c = 0; c < 3; ++c)
    now[c] = triangle.of(0, c) + u * (triangle.of(1, c) + u * triangle.of(2, c));
  const auto dot = [](const Eigen::Vector3f& d, const std::array<Eigen::Array4f, 3>& n) {
    return Eigen::Array4f(d[0] * n[0] + d[1] * n[1] + d[2] * n[2]);
  };
  f.at = dot(ray.middle, now);
  f.per_x = dot(ray.per_x, now);
  f.per_y = dot(ray.per_y, now);
  f.per_t = f.per_xt = f.per_yt = f.per_tt = Eigen::Array4f::Zero();
  if (!(half_u > 0)) return f;
  std::array<Eigen::Array4f, 3> per_t;
  std::array<Eigen::Array4f, 3> per_tt;
  for (std::size_t c = 0; c < 3; ++c) {
    per_t[c] = half_u * (triangle.of(1, c) + (2 * u) * triangle.of(2, c));
    per_tt[c] = (half_u * half_u) * triangle.of(2, c);
  }
  f.per_t = dot(ray.middle, per_t);
  f.per_xt = dot(ray.per_x, per_t);
  f.per_yt = dot(ray.per_y, per_t);
  f.per_tt = dot(ray.middle, per_tt);
  if (!ray.moves) return f;
  f.per_t += dot(ray.per_t, now);
  f.per_tt += dot(ray.per_t, per_t) + dot(ray.per_tt, now);
  return f;
}

PixelFunctions functions_about(
    const RayTriangle& triangle, const PixelRay& ray, float u, float half_u, float part_t) {
  if (part_t == 0) return functions_over(triangle, ray, u, half_u);
  PixelRay then = ray;
  then.middle += part_t * (ray.per_t + part_t * ray.per_tt);
  then.per_t += (2 * part_t) * ray.per_tt;
  PixelFunctions f = functions_over(triangle, then, u + part_t * half_u, half_u);
  f.at -= part_t * (f.per_t - part_t * f.per_tt);
  f.per_t -= (2 * part_t) * f.per_tt;
  f.per_x -= part_t * f.per_xt;
  f.per_y -= part_t * f.per_yt;
  return f;
}

bool PixelFunctions::is_uniform() const {
  // Largest shift of an edge by the terms of rotation and acceleration that are left out.
  constexpr float kLeftOutPx = 0.02f;
  const Eigen::Array4f left_out = 0.5f * (per_xt.abs() + per_yt.abs()) + 0.5f * per_tt.abs();
  const Eigen::Array4f slope = per_x.abs().max(per_y.abs());
  return hold_always() && (left_out <= kLeftOutPx * slope).head<3>().all();
}

PixelLines::PixelLines(int lines, bool by_time) : count(lines) {
  // Multiples of the golden ratio's inverse and of the square root of 2, less whole numbers: the
  // steps of lattices whose points lie in no few columns (Niederreiter 1978).
  constexpr double kGolden = 0.6180339887498949;
  constexpr double kSquareRoot = 0.4142135623730950;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const double key = (static_cast<double>(i) + 0.5) / count;
    const double other = std::fmod(0.5 + kGolden * static_cast<double>(i), 1.0);
    across[i] = static_cast<float>((by_time ? other : key) - 0.5);
    t[i] = by_time ? static_cast<float>(2 * key - 1) : 0;
    offset[i] = static_cast<float>(
        std::fmod(0.5 + (by_time ? kSquareRoot : kGolden) * static_cast<double>(i), 1.0));
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
