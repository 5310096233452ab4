// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "foundation/geometry/transform.h"
#include "picture/render/nearest.h"

// The visible parts of triangles in a pixel, from its depth buffer.
namespace airtruth::render {

// A part of a triangle that is visible in a pixel.
struct Piece {
  std::int32_t triangle;
  // The mean of its samples' places and times.
  std::array<float, 3> middle;
  // The number of its samples.
  float samples;
  // One of a few that are spread evenly over the triangle's visible part.
  bool leads;
};

class Pieces {
 public:
  // A triangle that is seen in many samples is divided by square blocks of its surface, so that
  // each piece has a place and a size of its own in the texture. During an exposure the pixel
  // sweeps over more of the surface, which has more blocks then. blocks: along a side. nearest,
  // places: of side x side samples, in the order of PixelSamples::fill_cells(). motion_px: of the
  // aircraft across the pixel during its exposure.
  Pieces(
      const Nearest& nearest, const Places& places, int side, int blocks, const Pixel& motion_px);

  // The number of the samples in which anything is visible.
  int covered() const { return covered_; }
  // Those of one triangle come one after another.
  std::span<const Piece> all() const { return {piece_.data(), count_}; }

 private:
  struct Group {
    std::int32_t triangle;
    int samples;
    // The numbers of blocks, and the first block in piece_.
    int columns;
    int rows;
    std::size_t first;
  };
  void count(const Nearest& nearest, int samples);
  void divide(int samples, int blocks, const Pixel& motion_px);
  void add(const Places& places, int samples, const Pixel& motion_px);
  void gather();

  std::size_t groups_ = 0;
  std::array<Group, Nearest::kMost> group_;
  // -1 where nothing is visible.
  std::array<std::int16_t, Nearest::kMost> group_of_;
  int covered_ = 0;
  std::size_t count_ = 0;
  std::array<Piece, 4 * Nearest::kMost> block_;
  std::array<Piece, Nearest::kMost> piece_;
};

}  // namespace airtruth::render
