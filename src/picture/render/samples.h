// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace airtruth::render {

// Where a pixel is sampled, in units of its sides from its top left corner: the two-dimensional
// Sobol sequence (Sobol 1967), xor-scrambled by the pixel (Kollig and Keller 2002). Any power of
// two of its points is a (0, 2)-net, which is what keeps the error of an edge small at every slope.
class PixelSamples {
 public:
  static constexpr int kMost = 4096;

  PixelSamples(int x, int y);
  std::array<double, 2> at(int i) const;  // i in [0, kMost); in (0, 1)
  // The first n of them, to 2^-23.
  void fill(int n, float* x, float* y) const;
  // When in the exposure a sample is taken, in (0, 1): the sequence's third dimension.
  double time(int i) const;
  void fill_times(int n, float* t) const;

 private:
  std::uint32_t scramble_x_;
  std::uint32_t scramble_y_;
  std::uint32_t scramble_t_;
};

// How many samples a pixel takes; powers of two.
struct SampleCounts {
  int base = 16;       // of every pixel that an aircraft may touch
  int edge = 512;      // of one that an outline crosses, by rays
  int outline = 1024;  // of one that an outline crosses, by Silhouette
  // Hits whose light is computed (the others only count): so many, or, where those are much alike,
  // so few.
  int shaded = 16;
  int shaded_alike = 8;
};

// quality: Options::quality (Error outside 1..5). size_px: the longest side of the largest
// aircraft.
SampleCounts counts_for(int quality, double size_px);

}  // namespace airtruth::render
