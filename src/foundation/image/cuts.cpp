// SPDX-License-Identifier: Apache-2.0
#include "foundation/image/cuts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "foundation/base/vectors.h"

namespace airtruth::image {
namespace {

// Numbers of cells over which a picture is averaged (cuts.h).
constexpr int kCellColumns = 32;
constexpr int kCellRows = 24;
// The least difference of a frame that begins a shot: the mean over the cells, in code values.
constexpr double kMinCutDifferenceCodes = 6;
// The least ratio of that difference to the difference of each neighbouring frame. Both limits are
// chosen: they find the cuts of the looked-at clips (docs/realism.md, "Cuts") and no pan.
constexpr double kMinRatioToNeighbours = 3;

// The first pixel of a cell where `count` cells share `size` pixels.
int cell_begin(int cell, int count, int size) { return (cell * size + count - 1) / count; }

// So many rows of 8-bit samples fit into 16-bit sums: 257 * 255 = 65535.
constexpr int kMaxRowsInSums = 257;

// Adds a row of samples to the sums of their columns. The inner loop has a constant length, so that
// compilers use vector instructions; they also need to know that the two do not overlap.
AIRTRUTH_FOR_VECTORS void add_row(const std::uint8_t* __restrict row,
                                  int width,
                                  std::uint16_t* __restrict column_sums) {
  // Number of samples: 32 of 8 bits are a vector of 256 bits.
  constexpr int kBlock = 32;
  int x = 0;
  for (; x + kBlock <= width; x += kBlock)
    for (int i = 0; i < kBlock; ++i)
      column_sums[x + i] = static_cast<std::uint16_t>(column_sums[x + i] + row[x + i]);
  for (; x < width; ++x) column_sums[x] = static_cast<std::uint16_t>(column_sums[x] + row[x]);
}

// The sums and numbers of luma samples by cell, row by row.
struct Cells {
  std::vector<double> sums = std::vector<double>(kCellColumns * kCellRows, 0);
  std::vector<double> counts = std::vector<double>(kCellColumns * kCellRows, 0);

  // Adds `rows` rows of one row of cells, summed by column, and clears the sums of the columns.
  void add(int cell_row, int rows, std::vector<std::uint16_t>& column_sums) {
    const int width = static_cast<int>(column_sums.size());
    for (int column = 0; column < kCellColumns; ++column) {
      const int begin = cell_begin(column, kCellColumns, width);
      const int end = cell_begin(column + 1, kCellColumns, width);
      const auto cell = static_cast<std::size_t>(cell_row * kCellColumns + column);
      sums[cell] += std::accumulate(column_sums.begin() + begin, column_sums.begin() + end, 0);
      counts[cell] += rows * (end - begin);
    }
    std::fill(column_sums.begin(), column_sums.end(), std::uint16_t{0});
  }
};

std::vector<double> means_by_cell(const Plane& luma) {
  Cells cells;
  std::vector<std::uint16_t> column_sums(static_cast<std::size_t>(luma.width), 0);
  int rows = 0;
  for (int y = 0; y < luma.height; ++y) {
    add_row(luma.row(y), luma.width, column_sums.data());
    ++rows;
    const int cell_row = y * kCellRows / luma.height;
    const bool is_last = (y + 1) * kCellRows / luma.height != cell_row;
    if (!is_last && rows < kMaxRowsInSums) continue;
    cells.add(cell_row, rows, column_sums);
    rows = 0;
  }
  for (std::size_t i = 0; i < cells.sums.size(); ++i)
    cells.sums[i] /= std::max(1.0, cells.counts[i]);
  return cells.sums;
}

}  // namespace

std::optional<double> Differences::add(const Picture& picture) {
  // Of R'G'B' the green plane, in which a cut shows as well.
  std::vector<double> cells = means_by_cell(picture.luma());
  std::optional<double> difference;
  if (!before_.empty()) {
    difference = 0;
    for (std::size_t i = 0; i < cells.size(); ++i)
      *difference += std::abs(cells[i] - before_[i]) / double(cells.size());
  }
  before_ = std::move(cells);
  return difference;
}

bool is_cut(std::span<const double> differences, std::size_t here) {
  constexpr std::size_t kReach = kCutNeighbours;
  double around = 0;
  for (std::size_t i = here - std::min(here, kReach);
       i < std::min(differences.size(), here + kReach + 1);
       ++i)
    if (i != here) around = std::max(around, differences[i]);
  return differences[here] >= kMinCutDifferenceCodes &&
         differences[here] > kMinRatioToNeighbours * around;
}

}  // namespace airtruth::image
