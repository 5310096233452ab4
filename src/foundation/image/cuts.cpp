// SPDX-License-Identifier: Apache-2.0
#include "foundation/image/cuts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace airtruth::image {
namespace {

constexpr int kCellColumns = 32;
constexpr int kCellRows = 24;
// The least difference of a frame that begins a shot: the mean over the cells, in code values.
constexpr double kMinCutDifferenceCodes = 6;
// The least ratio of that difference to the difference of each neighbouring frame. Both limits are
// chosen: they find the cuts of the looked-at clips (docs/realism.md, "Cuts") and no pan.
constexpr double kMinRatioToNeighbours = 3;

// The first pixel of a cell where `count` cells share `size` pixels.
int cell_begin(int cell, int count, int size) { return (cell * size + count - 1) / count; }

}  // namespace

std::optional<double> Differences::add(const Picture& picture) {
  std::vector<double> cells(kCellColumns * kCellRows, 0), counts(kCellColumns * kCellRows, 0);
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* row = picture.luma().row(y);
    const int line = y * kCellRows / picture.height * kCellColumns;
    for (int column = 0; column < kCellColumns; ++column) {
      const int begin = cell_begin(column, kCellColumns, picture.width);
      const int end = cell_begin(column + 1, kCellColumns, picture.width);
      const auto cell = static_cast<std::size_t>(line + column);
      cells[cell] += std::accumulate(row + begin, row + end, 0);
      counts[cell] += end - begin;
    }
  }
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] /= std::max(1.0, counts[i]);
  std::optional<double> difference;
  if (!before_.empty()) {
    difference = 0;
    for (std::size_t i = 0; i < cells.size(); ++i)
      *difference += std::abs(cells[i] - before_[i]) / double(cells.size());
  }
  before_ = std::move(cells);
  return difference;
}

bool is_cut(std::span<const double> before, double here, std::span<const double> after) {
  double around = 0;
  for (const double d : before) around = std::max(around, d);
  for (const double d : after) around = std::max(around, d);
  return here >= kMinCutDifferenceCodes && here > kMinRatioToNeighbours * around;
}

}  // namespace airtruth::image
