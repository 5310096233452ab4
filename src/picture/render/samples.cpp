// SPDX-License-Identifier: Apache-2.0
#include "picture/render/samples.h"

#include <string>

#include "foundation/base/error.h"

namespace airtruth::render {
namespace {

std::uint32_t hashed(std::uint32_t x, std::uint32_t y) {
  std::uint32_t h = x * 0x9e3779b1u ^ (y + 0x7f4a7c15u) * 0x85ebca77u;
  h ^= h >> 16, h *= 0x7feb352du, h ^= h >> 15, h *= 0x846ca68bu, h ^= h >> 16;
  return h;
}

struct SobolPoints {
  std::array<std::uint32_t, PixelSamples::kMost> x;
  std::array<std::uint32_t, PixelSamples::kMost> y;
  std::array<std::uint32_t, PixelSamples::kMost> t;
};

// Direction numbers of the primitive polynomial x^2 + x + 1 (Sobol 1967; m = 1, 3).
constexpr std::array<std::uint32_t, 12> third_directions() {
  std::array<std::uint32_t, 12> v{1u << 31, 3u << 30};
  for (std::size_t i = 2; i < v.size(); ++i) v[i] = v[i - 1] ^ v[i - 2] ^ (v[i - 2] >> 2);
  return v;
}

constexpr SobolPoints sobol_points() {
  SobolPoints points{};
  constexpr auto third = third_directions();
  for (std::uint32_t n = 0; n < PixelSamples::kMost; ++n) {
    std::uint32_t vx = 1u << 31;
    std::uint32_t vy = 1u << 31;
    for (std::uint32_t i = n; i != 0; i >>= 1, vx >>= 1, vy ^= vy >> 1) {
      if ((i & 1u) != 0) {
        points.x[n] ^= vx;
        points.y[n] ^= vy;
      }
    }
    for (std::uint32_t bit = 0; bit < third.size(); ++bit)
      if ((n >> bit & 1u) != 0) points.t[n] ^= third[bit];
  }
  return points;
}

constexpr SobolPoints kPoints = sobol_points();

// The same points, ordered by the remainder of their index by kStrips.
constexpr SobolPoints strip_points() {
  SobolPoints sorted{};
  std::size_t to = 0;
  for (std::size_t remainder = 0; remainder < PixelSamples::kStrips; ++remainder)
    for (std::size_t n = remainder; n < PixelSamples::kMost; n += PixelSamples::kStrips, ++to) {
      sorted.x[to] = kPoints.x[n];
      sorted.y[to] = kPoints.y[n];
      sorted.t[to] = kPoints.t[n];
    }
  return sorted;
}

constexpr SobolPoints kStripPoints = strip_points();

// The index of the point in each cell of a grid over the pixel, before the scrambling.
template <std::uint32_t kSide>
constexpr std::array<std::uint16_t, kSide * kSide> points_of_cells() {
  std::array<std::uint16_t, kSide * kSide> result{};
  constexpr std::uint32_t kCell = static_cast<std::uint32_t>((std::uint64_t{1} << 32) / kSide);
  for (std::uint32_t n = 0; n < kSide * kSide; ++n)
    result[kPoints.x[n] / kCell * kSide + kPoints.y[n] / kCell] = static_cast<std::uint16_t>(n);
  return result;
}

template <std::uint32_t kSide>
constexpr auto kPointsOfCells = points_of_cells<kSide>();

float unit(std::uint32_t bits) {
  return (static_cast<float>(static_cast<std::int32_t>(bits >> 9)) + 0.5f) * 0x1.0p-23f;
}

}  // namespace

PixelSamples::PixelSamples(int x, int y)
    : scramble_x_(hashed(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y))),
      scramble_y_(hashed(scramble_x_, 0x68bc21ebu)),
      scramble_t_(hashed(scramble_y_, 0x02e5be93u)) {}

std::array<double, 2> PixelSamples::at(int i) const {
  const auto n = static_cast<std::size_t>(i);
  return {((kPoints.x[n] ^ scramble_x_) + 0.5) * 0x1.0p-32,
          ((kPoints.y[n] ^ scramble_y_) + 0.5) * 0x1.0p-32};
}

double PixelSamples::time(int i) const {
  return ((kPoints.t[static_cast<std::size_t>(i)] ^ scramble_t_) + 0.5) * 0x1.0p-32;
}

void PixelSamples::fill_times(int n, float* t) const {
  fill_strips(n, kStripPoints.t, scramble_t_, t);
}

template <std::uint32_t kSide>
void PixelSamples::fill_grid(float* x, float* y, float* t) const {
  constexpr std::uint32_t kCell = static_cast<std::uint32_t>((std::uint64_t{1} << 32) / kSide);
  const std::uint32_t column = scramble_x_ / kCell;
  const std::uint32_t row = scramble_y_ / kCell;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    const std::uint16_t n = kPointsOfCells<kSide>[(i / kSide ^ column) * kSide + (i % kSide ^ row)];
    x[i] = unit(kPoints.x[n] ^ scramble_x_);
    y[i] = unit(kPoints.y[n] ^ scramble_y_);
    t[i] = unit(kPoints.t[n] ^ scramble_t_);
  }
}

void PixelSamples::fill_cells(int side, float* x, float* y, float* t) const {
  if (side == 8)
    fill_grid<8>(x, y, t);
  else
    fill_grid<16>(x, y, t);
}

void PixelSamples::fill(int n, float* x, float* y) const {
  fill_strips(n, kStripPoints.x, scramble_x_, x);
  fill_strips(n, kStripPoints.y, scramble_y_, y);
}

void PixelSamples::fill_strips(int n,
                               const std::array<std::uint32_t, kMost>& points,
                               std::uint32_t scramble,
                               float* to) const {
  const int each = n / kStrips;
  for (int remainder = 0; remainder < kStrips; ++remainder) {
    const std::uint32_t* from = points.data() + remainder * (kMost / kStrips);
    float* strip = to + strip_of(remainder) * each;
    for (int j = 0; j < each; ++j) strip[j] = unit(from[j] ^ scramble);
  }
}

void PixelSamples::fill_in_sequence(int n, float* x, float* y, float* t) const {
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
    x[i] = unit(kPoints.x[i] ^ scramble_x_);
    y[i] = unit(kPoints.y[i] ^ scramble_y_);
    t[i] = unit(kPoints.t[i] ^ scramble_t_);
  }
}

SampleCounts counts_for(int quality, double size_px) {
  switch (quality) {
    case 1:
      return {4, 32, 64, 4, 4, 8, 2};
    case 2:
      return {16, 128, 256, 8, 4, 8, 2};
    case 3:
      // In a smaller aircraft each pixel contains more of the livery, and fewer pixels need
      // samples.
      if (size_px <= 24) return {64, 1024, 1024, 64, 64, 16, 8, true};
      if (size_px <= 64) return {16, 512, 512, 32, 16, 8, 4, true};
      // A larger aircraft has more pixels on its outline, and with them a larger worst error.
      return {16, 256, size_px <= 256 ? 512 : 2048, 16, 8, 8, 3};
    case 4:
      return {64, 1024, 4096, 16, 16, 8, 4};
    case 5:
      return {4096, 4096, 0, 16, 16, 8, 4};
    default:
      break;
  }
  throw Error("render quality is " + std::to_string(quality) +
              "; expected 1 (draft) to 5 (oracle)");
}

}  // namespace airtruth::render
