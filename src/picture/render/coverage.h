// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "picture/render/pixel_rays.h"
#include "picture/render/ray_triangles.h"

// The share of a pixel and of its exposure that opaque triangles cover. Parallel lines cross the
// pixel (line samples: Jones and Perry 2000, "Antialiasing with line samples"), each at a place
// across them and, with an exposure, at a time of its own. A triangle covers an interval of each
// line, between its edges; the union of all triangles is kept as a mask of 31 places a line, one
// bit each (coverage masks: Carpenter 1984, "The A-buffer"). An edge that is not along the lines is
// then as exact as 31 samples a line make it, at a little more than the cost of one sample.
namespace airtruth::render {

// The three edge functions and the inverse distance of a RayTriangle over a pixel and its exposure,
// in the units of Samples:
//
//   (at + per_t t + per_tt t^2) + x (per_x + per_xt t) + y (per_y + per_yt t)
//
// The terms that no sample can tell are left out.
struct PixelFunctions {
  Eigen::Array4f at, per_x, per_y, per_t, per_xt, per_yt, per_tt;
  // The times at which they hold, which are all but for a part that turns.
  float begin_t = -2;
  float end_t = 2;

  Eigen::Array4f operator()(float x, float y, float t) const {
    return (at + per_t * t + per_tt * (t * t)) + x * (per_x + per_xt * t) +
           y * (per_y + per_yt * t);
  }
  // What no value over the pixel and the exposure deviates by from that in the middle.
  Eigen::Array4f half_range() const {
    return 0.5f * (per_x.abs() + per_y.abs()) + per_t.abs() + 0.5f * (per_xt.abs() + per_yt.abs()) +
           per_tt.abs();
  }
  bool hold_always() const { return begin_t <= -1 && end_t >= 1; }
  // True where they hold always and the motion is uniform to within a fiftieth of a pixel, so that
  // the terms of rotation and of acceleration change alpha by less than the samples leave: at an
  // edge a deviation that is uniform between -e and e adds e / 4 to the mean.
  bool is_uniform() const;
};

// `u`: the middle of the pixel's exposure in the triangle's span; `half_u`: half of the exposure.
PixelFunctions functions_over(const RayTriangle& triangle,
                              const PixelRay& ray,
                              float u,
                              float half_u);
// The same for a part of the exposure whose middle is `part_t`, -1 to 1 from the exposure's
// beginning to its end: the slopes, which are linear in time, hold there.
PixelFunctions functions_about(
    const RayTriangle& triangle, const PixelRay& ray, float u, float half_u, float part_t);

// The lines of a pixel, the same for all pixels. `key` divides them evenly and in order: at an
// instant by the place across, with an exposure by the time.
struct PixelLines {
  // Number of places of a line: a mask of 32 bits holds 31 without a shift by 32.
  static constexpr int kPlaces = 31;
  // Most lines: 64 blocks of 8, one bit each of CoverageMasks::full_blocks_.
  static constexpr int kMost = 512;
  // Number of lines that are tested together: 8 floats are a vector of 256 bits.
  static constexpr int kBlock = 8;
  int count = 0;
  // From the pixel's middle in units of its side.
  alignas(64) std::array<float, kMost> across;
  // From the middle of the exposure in units of half of it.
  alignas(64) std::array<float, kMost> t;
  // Of the first place, in steps between places, so that the lines' places differ.
  alignas(64) std::array<float, kMost> offset;

  // `count`: a multiple of kBlock.
  PixelLines(int count, bool by_time);
};

class CoverageMasks {
 public:
  // `along_y`: the lines are along y, else along x.
  void begin(const PixelLines& lines, bool along_y) {
    lines_ = &lines;
    along_y_ = along_y;
    full_blocks_ = 0;
    std::fill_n(masks_.begin(), lines.count, 0u);
  }
  // Adds what a triangle covers of the lines whose key is in [from, to], as shares of all keys.
  void add(const PixelFunctions& functions, float from, float to);
  bool is_full() const { return full_blocks_ == all_blocks(); }
  // 0..1.
  double share() const {
    int places = 0;
    for (int i = 0; i < lines_->count; i += 2)
      places += std::popcount(std::bit_cast<std::uint64_t>(std::array{
          masks_[static_cast<std::size_t>(i)], masks_[static_cast<std::size_t>(i) + 1]}));
    return static_cast<double>(places) / (lines_->count * PixelLines::kPlaces);
  }

 private:
  std::uint64_t all_blocks() const {
    return ~std::uint64_t{0} >> (64 - lines_->count / PixelLines::kBlock);
  }

  const PixelLines* lines_ = nullptr;
  bool along_y_ = false;
  // Blocks all of whose lines are covered.
  std::uint64_t full_blocks_ = 0;
  alignas(64) std::array<std::uint32_t, PixelLines::kMost> masks_;
};

}  // namespace airtruth::render
