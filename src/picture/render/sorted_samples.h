// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "picture/render/marking.h"
#include "picture/render/straight.h"

// The samples of one pixel during an exposure, by cells, so that a small triangle is tested against
// those that can see it and not against all.
//
// During an exposure the picture of an aircraft moves over the pixel by nearly the same distance
// everywhere. Cells of the moving picture hold the samples that see the same part of the aircraft,
// whatever their time: a sample at x and time t (0 to 1) is in the cell of x - (2 t - 1) drift.
namespace airtruth::render {

class SortedSamples {
 public:
  // drift: what the picture moves from the middle of the exposure to its end, in pixels. `order`
  // receives where each sample of the pixel's sequence is.
  void fill(const PixelSamples& pixel,
            int samples,
            const Pixel& drift,
            std::vector<std::uint16_t>& order);

  // Marks the samples that a triangle covers among those of the cells that it can touch. sides: the
  // triangle's over the pixel of column x.
  void mark(const RowTriangle& triangle,
            int x,
            const std::array<Straight, 3>& sides,
            std::int32_t* covered);
  const Places& places() const { return places_; }
  // The number of the samples that mark() has not covered.
  int open() const { return open_; }

 private:
  // Along each side of the span of all samples.
  static constexpr int kCells = 8;
  // Along one axis: the number of the cell of place x is (x + reach) * per_px.
  struct Axis {
    float drift = 0;
    float reach = 0;
    float per_px = kCells;
    explicit Axis(double drift_px = 0);
  };
  // The first and the last cell along an axis that a triangle between two places can touch.
  struct Cells {
    int first;
    int last;
  };
  static Cells cells_between(float low, float high, float drift, float spread, const Axis& axis);
  int start(int column, int row) const {
    return starts_[static_cast<std::size_t>(column * kCells + row)];
  }

  Axis x_;
  Axis y_;
  Places places_;
  // Where the samples of each cell begin: cell column * kCells + row.
  std::array<std::uint16_t, kCells * kCells + 1> starts_;
  int open_ = 0;
};

}  // namespace airtruth::render
