// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "picture/render/samples.h"

namespace airtruth::render {

// The samples, among a pixel's first n, that an aircraft covers.
struct Cover {
  int covered = 0;
  // 0 or -1 for each sample, in an order of its own.
  std::vector<std::int32_t> marks;
  // Where the samples of the pixel's sequence are in that order; empty: the order is that of
  // PixelSamples::fill().
  std::vector<std::uint16_t> order;
  // Of Silhouette::cover_mixed(), for translucent triangles, in the order of marks: samples with
  // equal numbers are covered by the same triangles. The lowest bit is 1 where the opacity of one
  // of them differs from place to place.
  std::vector<std::uint32_t> triangles;

  // i: of the sequence.
  bool covers(const PixelSamples& pixel, int i) const { return marks[place(pixel, i)] != 0; }
  // Where sample i is in `marks`.
  std::size_t place(const PixelSamples& pixel, int i) const {
    return order.empty() ? static_cast<std::size_t>(pixel.place(i, samples()))
                         : order[static_cast<std::size_t>(i)];
  }
  int samples() const { return static_cast<int>(marks.size()); }
};

}  // namespace airtruth::render
