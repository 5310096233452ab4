// SPDX-License-Identifier: Apache-2.0
#include "picture/render/sorted_samples.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "foundation/base/vectors.h"

namespace airtruth::render {
namespace {

// The cell of each sample in the moving picture.
AIRTRUTH_FOR_SHORT_VECTORS
void find_cells(const float* px,
                const float* py,
                const float* pt,
                int n,
                float drift_x,
                float drift_y,
                float reach_x,
                float reach_y,
                float per_px_x,
                float per_px_y,
                int along,
                std::int32_t* cells) {
  for (int i = 0; i < n; ++i) {
    const float u = 2 * pt[i] - 1;
    const auto column = static_cast<std::int32_t>((px[i] - drift_x * u + reach_x) * per_px_x);
    const auto row = static_cast<std::int32_t>((py[i] - drift_y * u + reach_y) * per_px_y);
    const std::int32_t in_columns = column < 0 ? 0 : column >= along ? along - 1 : column;
    const std::int32_t in_rows = row < 0 ? 0 : row >= along ? along - 1 : row;
    cells[i] = in_columns * along + in_rows;
  }
}

// The samples from one place to another, both multiples of kAtOnce.
struct Run {
  // Of one vector.
  static constexpr int kAtOnce = 8;
  int from = 0;
  int to = 0;
};

// Marks the samples of some runs that are inside three sides; the runs have no sample in common.
// Returns how many were not covered before.
AIRTRUTH_FOR_SHORT_VECTORS
int mark_runs(const Straight* sides,
              const float* px,
              const float* py,
              const float* pt,
              const Run* runs,
              std::size_t count,
              std::int32_t* covered) {
  const Straight p = sides[0];
  const Straight q = sides[1];
  const Straight r = sides[2];
  std::int32_t more = 0;
  for (std::size_t run = 0; run < count; ++run) {
    const int to = runs[run].to;
    for (int i = runs[run].from; i < to; ++i) {
      const float x = px[i];
      const float y = py[i];
      const float t = pt[i];
      const float u = (p.a + p.b * x) + (p.c * y + p.d * t);
      const float v = (q.a + q.b * x) + (q.c * y + q.d * t);
      const float w = (r.a + r.b * x) + (r.c * y + r.d * t);
      const std::int32_t before = covered[i];
      const std::int32_t now = before | -static_cast<std::int32_t>((u >= 0) & (v >= 0) & (w >= 0));
      covered[i] = now;
      more += before - now;
    }
  }
  return more;
}

}  // namespace

SortedSamples::Axis::Axis(double drift_px)
    : drift(static_cast<float>(drift_px)),
      reach(std::abs(drift)),
      per_px(static_cast<float>(kCells) / (1 + 2 * reach)) {}

void SortedSamples::fill(const PixelSamples& pixel,
                         int samples,
                         const Pixel& drift,
                         std::vector<std::uint16_t>& order) {
  thread_local Places unsorted;
  thread_local std::vector<std::int32_t> cells;
  open_ = samples;
  x_ = Axis(drift.x());
  y_ = Axis(drift.y());
  pixel.fill_in_sequence(samples, unsorted.x.data(), unsorted.y.data(), unsorted.t.data());
  const auto n = static_cast<std::size_t>(samples);
  cells.resize(n);
  find_cells(unsorted.x.data(),
             unsorted.y.data(),
             unsorted.t.data(),
             samples,
             x_.drift,
             y_.drift,
             x_.reach,
             y_.reach,
             x_.per_px,
             y_.per_px,
             kCells,
             cells.data());
  starts_.fill(0);
  for (std::size_t i = 0; i < n; ++i) ++starts_[static_cast<std::size_t>(cells[i]) + 1];
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
  std::array<std::uint16_t, kCells * kCells> next;
  std::copy_n(starts_.begin(), next.size(), next.begin());
  order.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint16_t to = next[static_cast<std::size_t>(cells[i])]++;
    order[i] = to;
    places_.x[to] = unsorted.x[i];
    places_.y[to] = unsorted.y[i];
    places_.t[to] = unsorted.t[i];
  }
}

SortedSamples::Cells SortedSamples::cells_between(
    float low, float high, float drift, float spread, const Axis& axis) {
  // Covers the rounding of places in single precision, in pixels for each pixel of the cells' span.
  constexpr float kRounding = 1e-5F;
  const float margin = std::abs(drift - axis.drift) + spread + kRounding * (1 + 2 * axis.reach);
  const auto cell = [&](float place) {
    const float at = (place + axis.reach) * axis.per_px;
    return static_cast<int>(std::clamp(at, 0.0F, static_cast<float>(kCells - 1)));
  };
  return {cell(low - margin), cell(high + margin)};
}

void SortedSamples::mark(const RowTriangle& triangle,
                         int x,
                         const std::array<Straight, 3>& sides,
                         std::int32_t* covered) {
  constexpr int kAtOnce = Run::kAtOnce;
  const Cells columns = cells_between(static_cast<float>(triangle.left - x),
                                      static_cast<float>(triangle.right - x),
                                      triangle.drift_x,
                                      triangle.spread,
                                      x_);
  const Cells rows =
      cells_between(triangle.top, triangle.bottom, triangle.drift_y, triangle.spread, y_);
  std::array<Run, kCells> runs;
  std::size_t count = 0;
  int done = 0;
  for (int column = columns.first; column <= columns.last; ++column) {
    // The samples beside a cell may be tested too: the sides decide.
    const int from = std::max(done, start(column, rows.first) / kAtOnce * kAtOnce);
    const int to = (start(column, rows.last + 1) + kAtOnce - 1) / kAtOnce * kAtOnce;
    if (from >= to) continue;
    if (count > 0 && from == done)
      runs[count - 1].to = to;
    else
      runs[count++] = {from, to};
    done = to;
  }
  open_ -= mark_runs(sides.data(),
                     places_.x.data(),
                     places_.y.data(),
                     places_.t.data(),
                     runs.data(),
                     count,
                     covered);
}

}  // namespace airtruth::render
