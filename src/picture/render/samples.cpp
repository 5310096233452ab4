// SPDX-License-Identifier: Apache-2.0
#include "picture/render/samples.h"

#include <algorithm>
#include <bit>
#include <string>
#include <vector>

#include "foundation/base/error.h"

namespace airtruth::render {
namespace {

std::uint32_t hashed(std::uint32_t x, std::uint32_t y) {
  std::uint32_t h = x * 0x9e3779b1u ^ (y + 0x7f4a7c15u) * 0x85ebca77u;
  h ^= h >> 16, h *= 0x7feb352du, h ^= h >> 15, h *= 0x846ca68bu, h ^= h >> 16;
  return h;
}

using SobolPoint = std::array<std::uint32_t, 3>;
// The dimensions of a point by which blocks divide them: place across and time.
constexpr std::size_t kX = 0;
constexpr std::size_t kT = 2;

// Direction numbers of the primitive polynomial x^2 + x + 1 (Sobol 1967; m = 1, 3).
constexpr std::array<std::uint32_t, 12> third_directions() {
  std::array<std::uint32_t, 12> v{1u << 31, 3u << 30};
  for (std::size_t i = 2; i < v.size(); ++i) v[i] = v[i - 1] ^ v[i - 2] ^ (v[i - 2] >> 2);
  return v;
}

constexpr SobolPoint sobol_point(std::uint32_t n) {
  constexpr auto third = third_directions();
  SobolPoint point{};
  std::uint32_t vx = 1u << 31;
  std::uint32_t vy = 1u << 31;
  for (std::uint32_t i = n; i != 0; i >>= 1, vx >>= 1, vy ^= vy >> 1)
    if ((i & 1u) != 0) {
      point[0] ^= vx;
      point[1] ^= vy;
    }
  for (std::uint32_t bit = 0; bit < third.size(); ++bit)
    if ((n >> bit & 1u) != 0) point[2] ^= third[bit];
  return point;
}

// The first n points, by their block of one dimension before the scrambling.
struct SortedPoints {
  std::array<std::vector<std::uint32_t>, 3> of;

  SortedPoints(int n, std::size_t dimension) {
    const int shift = 32 - std::countr_zero(static_cast<unsigned>(n / Samples::kBlock));
    std::vector<SobolPoint> points;
    for (int i = 0; i < n; ++i) points.push_back(sobol_point(static_cast<std::uint32_t>(i)));
    std::stable_sort(points.begin(), points.end(), [&](const SobolPoint& a, const SobolPoint& b) {
      return a[dimension] >> shift < b[dimension] >> shift;
    });
    for (const SobolPoint& point : points)
      for (std::size_t k = 0; k < 3; ++k) of[k].push_back(point[k]);
  }
};

const SortedPoints& sorted_points(int n, bool by_time) {
  static const std::vector<std::array<SortedPoints, 2>> all = [] {
    std::vector<std::array<SortedPoints, 2>> result;
    for (int count = PixelSamples::kFewest; count <= Samples::kMost; count *= 2)
      result.push_back({SortedPoints(count, kX), SortedPoints(count, kT)});
    return result;
  }();
  return all[static_cast<std::size_t>(
      std::countr_zero(static_cast<unsigned>(n / PixelSamples::kFewest)))][by_time ? 1 : 0];
}

}  // namespace

PixelSamples::PixelSamples(int x, int y) {
  scramble_[0] = hashed(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
  scramble_[1] = hashed(scramble_[0], 0x68bc21ebu);
  scramble_[2] = hashed(scramble_[1], 0x02e5be93u);
}

void PixelSamples::fill(int n, bool by_time, Samples& samples) const {
  samples.count = n;
  const SortedPoints& points = sorted_points(n, by_time);
  constexpr int kBlock = Samples::kBlock;
  const int blocks = n / kBlock;
  // The scrambling permutes the blocks.
  const int shift = 32 - std::countr_zero(static_cast<unsigned>(blocks));
  const auto turned = static_cast<int>(scramble_[by_time ? kT : kX] >> shift);
  const auto copy = [&](std::size_t dimension, float scale, float* to) {
    // As a signed number the middle is 0.
    const std::uint32_t scramble = scramble_[dimension] ^ 0x80000000u;
    for (int block = 0; block < blocks; ++block) {
      const std::uint32_t* from = points.of[dimension].data() + (block ^ turned) * kBlock;
      for (int i = 0; i < kBlock; ++i)
        to[block * kBlock + i] =
            (static_cast<float>(static_cast<std::int32_t>(from[i] ^ scramble) >> 8) + 0.5f) * scale;
    }
  };
  copy(0, 0x1p-24f, samples.x.data());
  copy(1, 0x1p-24f, samples.y.data());
  copy(2, 0x1p-23f, samples.t.data());
}

std::array<double, 3> PixelSamples::at(int i) const {
  const SobolPoint point = sobol_point(static_cast<std::uint32_t>(i));
  std::array<double, 3> result;
  for (std::size_t k = 0; k < 3; ++k) result[k] = ((point[k] ^ scramble_[k]) + 0.5) * 0x1p-32;
  return result;
}

SampleCounts counts_for(int quality, bool exposes) {
  const int more = exposes ? 2 : 1;
  switch (quality) {
    case 1:
      return {32 * more * more, 64, 64};
    case 2:
      return {64 * more * more, 64, 256 * more};
    case 3:
      return {exposes ? 384 : 128, 64, 512 * more};
    case 4:
      return {256 * more, 256, 1024 * more};
    case 5:
      return {0, PixelSamples::kMost, PixelSamples::kMost, true};
    default:
      break;
  }
  throw Error("render quality is " + std::to_string(quality) +
              "; expected 1 (draft) to 5 (oracle)");
}

}  // namespace airtruth::render
