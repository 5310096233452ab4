// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace airtruth::render {

// The sample points of a pixel, in units of its sides from its top left corner: the two-dimensional
// Sobol sequence (Sobol 1967), xor-scrambled by the pixel (Kollig and Keller 2002). Any power of
// two of its points is a (0, 2)-net, which keeps the error at an edge small for every slope.
class PixelSamples {
 public:
  // Largest number of samples of a pixel.
  static constexpr int kMost = 4096;

  PixelSamples(int x, int y);
  // i lies in [0, kMost); the coordinates lie in (0, 1).
  std::array<double, 2> at(int i) const;
  // The first n points, accurate to 2^-23.
  void fill(int n, float* x, float* y) const;
  // The time of a sample within the exposure, in (0, 1): the third dimension of the sequence.
  double time(int i) const;
  void fill_times(int n, float* t) const;

 private:
  std::uint32_t scramble_x_;
  std::uint32_t scramble_y_;
  std::uint32_t scramble_t_;
};

// The numbers of samples of a pixel; powers of two.
struct SampleCounts {
  // For every pixel that an aircraft may touch.
  int base = 16;
  // For a pixel that an outline crosses, by rays.
  int edge = 512;
  // For a pixel that an outline crosses, by Silhouette.
  int outline = 1024;
  // Hits whose light is computed; the other hits only count as coverage. `shaded_alike` applies
  // where the computed colours are nearly equal.
  int shaded = 16;
  int shaded_alike = 8;
};

// quality: Options::quality (Error outside 1..5). size_px: the longest side of the largest
// aircraft.
SampleCounts counts_for(int quality, double size_px);

}  // namespace airtruth::render
