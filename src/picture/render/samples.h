// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace airtruth::render {

// The samples of a pixel as arrays: places from the pixel's middle in units of its sides, and times
// from the middle of its exposure in units of half of it. Blocks divide them evenly by place across
// (x) or by time (t): block k of n holds those with that coordinate from k / n to (k + 1) / n of
// its span.
struct Samples {
  // Most samples of a pixel, as counts_for gives them, and the number in a block: 8 floats are a
  // vector of 256 bits.
  static constexpr int kMost = 2048;
  static constexpr int kBlock = 8;
  int count = 0;
  // One after another, block by block.
  alignas(64) std::array<float, kMost> x;
  alignas(64) std::array<float, kMost> y;
  alignas(64) std::array<float, kMost> t;
};

// The sample points of a pixel: the three-dimensional Sobol sequence (Sobol 1967), two dimensions
// for the place and one for the time, xor-scrambled by the pixel (Kollig and Keller 2002). Any
// power of two of its places is a (0, 2)-net, which keeps the error at an edge small for every
// slope.
class PixelSamples {
 public:
  // Numbers of points: two blocks are the fewest that divide a dimension; the most are the
  // reference's.
  static constexpr int kFewest = 2 * Samples::kBlock;
  static constexpr int kMost = 4096;

  PixelSamples(int x, int y);
  // The first n points, in blocks by time or by place. n: a power of two from kFewest to
  // Samples::kMost.
  void fill(int n, bool by_time, Samples& samples) const;
  // Point i of [0, kMost): its place from the pixel's top left corner, and its time from the
  // beginning of the exposure, each in (0, 1).
  std::array<double, 3> at(int i) const;

 private:
  std::array<std::uint32_t, 3> scramble_;
};

// The numbers of samples of a pixel, by the quality of a picture.
struct SampleCounts {
  // Lines of the coverage masks.
  int lines = 128;
  // Samples of the visibility buffer where masks tell alpha, or no outline crosses the pixel.
  int where_even = 64;
  // Samples where outlines of translucent surfaces or several aircraft cross the pixel.
  int on_outline = 512;
  // True for the reference: every pixel has PixelSamples::kMost rays.
  bool by_rays = false;
};

// quality: Options::quality (Error outside 1..5). exposes: whether the samples differ in time too;
// the same error then takes more of them.
SampleCounts counts_for(int quality, bool exposes);

}  // namespace airtruth::render
