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

  // i: of the sequence.
  bool covers(const PixelSamples& pixel, int i) const {
    const std::size_t place = order.empty() ? static_cast<std::size_t>(pixel.place(i, samples()))
                                            : order[static_cast<std::size_t>(i)];
    return marks[place] != 0;
  }
  int samples() const { return static_cast<int>(marks.size()); }
};

}  // namespace airtruth::render
