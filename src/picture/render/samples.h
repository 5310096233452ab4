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
  // The time of a sample within the exposure, in (0, 1): the third dimension of the sequence.
  double time(int i) const;

  // Vertical strips of one width, in which the points of a pixel are stored: strip s of kStrips
  // holds the points with x from s / kStrips to (s + 1) / kStrips, which are one in kStrips of any
  // first n points (n is a multiple of kStrips).
  static constexpr int kStrips = 8;
  // The first n points strip by strip, accurate to 2^-23.
  void fill(int n, float* x, float* y) const;
  void fill_times(int n, float* t) const;
  // The first side^2 points (side: 8 or 16) cell by cell: the points are a net, so that each cell
  // of a grid of side x side over the pixel contains one. Place column * side + row holds the point
  // of that cell, so that columns are strips, or halves of them.
  void fill_cells(int side, float* x, float* y, float* t) const;
  // The first n points in their own order.
  void fill_in_sequence(int n, float* x, float* y, float* t) const;
  // The place of point i among the first n in the order of fill().
  int place(int i, int n) const { return strip_of(i % kStrips) * (n / kStrips) + i / kStrips; }

 private:
  // The strip of the points i with that remainder of i / kStrips: x begins with the reversed last
  // bits of i.
  int strip_of(int remainder) const {
    constexpr std::array<int, kStrips> kReversed = {0, 4, 2, 6, 1, 5, 3, 7};
    return kReversed[static_cast<std::size_t>(remainder)] ^ static_cast<int>(scramble_x_ >> 29);
  }

  template <std::uint32_t kSide>
  void fill_grid(float* x, float* y, float* t) const;
  void fill_strips(int n,
                   const std::array<std::uint32_t, kMost>& points,
                   std::uint32_t scramble,
                   float* to) const;

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
  // Hits of rays whose light is computed; the other hits only count as coverage.
  int shaded = 16;
  // Largest value of `shaded`.
  static constexpr std::size_t kMostShaded = 64;
  // How many of them are traced at once, before a look at the variance of their colours.
  int shaded_alike = 8;
  // Samples along a side of a pixel whose visible surface is found by Silhouette: 8 or 16.
  int visible_side = 8;
  // Blocks along a side of a pixel, of which each has its own light.
  int blocks = 3;
  // True where most pixels are on an outline: each then takes `outline` samples at once, rather
  // than after a look at few samples of its neighbours.
  bool at_once = false;
  // True where Silhouette finds the visible surfaces, and false where rays do.
  bool sees = true;
};

// quality: Options::quality (Error outside 1..5). size_px: the longest side of the largest
// aircraft.
SampleCounts counts_for(int quality, double size_px);

}  // namespace airtruth::render
