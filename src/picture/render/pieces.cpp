// SPDX-License-Identifier: Apache-2.0
#include "picture/render/pieces.h"

#include <algorithm>
#include <cmath>

namespace airtruth::render {
namespace {

// A triangle in at least this share of the samples has all blocks, and a smaller one half of them.
constexpr int kLargeShare = 16;  // one in
// Largest number of blocks along a side.
constexpr int kMostBlocks = 16;

}  // namespace

Pieces::Pieces(
    const Nearest& nearest, const Places& places, int side, int blocks, const Pixel& motion_px) {
  const int samples = side * side;
  count(nearest, samples);
  divide(samples, blocks, motion_px);
  add(places, samples, motion_px);
  gather();
}

void Pieces::count(const Nearest& nearest, int samples) {
  std::size_t last = 0;
  for (int i = 0; i < samples; ++i) {
    const std::int32_t triangle = nearest.triangle[static_cast<std::size_t>(i)];
    group_of_[static_cast<std::size_t>(i)] = -1;
    if (triangle < 0) continue;
    ++covered_;
    if (last >= groups_ || group_[last].triangle != triangle) {
      last = 0;
      while (last < groups_ && group_[last].triangle != triangle) ++last;
      if (last == groups_) group_[groups_++] = {triangle, 0, 0, 0};
    }
    ++group_[last].samples;
    group_of_[static_cast<std::size_t>(i)] = static_cast<std::int16_t>(last);
  }
}

void Pieces::divide(int samples, int blocks, const Pixel& motion_px) {
  const auto over = [](int still, double motion) {
    return std::min(kMostBlocks, static_cast<int>(std::ceil(still * (1 + std::abs(motion)))));
  };
  for (std::size_t g = 0; g < groups_; ++g) {
    Group& group = group_[g];
    const bool is_large = group.samples * kLargeShare >= samples;
    const int still = is_large ? blocks : std::max(1, blocks / 4);
    group.columns = still == 1 ? 1 : over(still, motion_px.x());
    group.rows = still == 1 ? 1 : over(still, motion_px.y());
    if (count_ + static_cast<std::size_t>(group.columns * group.rows) + groups_ > block_.size())
      group.columns = group.rows = 1;
    group.first = count_;
    for (int column = 0; column < group.columns; ++column)
      for (int row = 0; row < group.rows; ++row) {
        // Of four by four blocks one in each row and column.
        const bool leads = (column + 3 * row + 4) % 5 == 0;
        block_[count_++] = {group.triangle, {}, 0, leads};
      }
  }
}

void Pieces::add(const Places& places, int samples, const Pixel& motion_px) {
  const auto dx = static_cast<float>(motion_px.x());
  const auto dy = static_cast<float>(motion_px.y());
  const float per_x = 1 / (1 + std::abs(dx));
  const float per_y = 1 / (1 + std::abs(dy));
  for (std::size_t i = 0; i < static_cast<std::size_t>(samples); ++i) {
    if (group_of_[i] < 0) continue;
    const Group& group = group_[static_cast<std::size_t>(group_of_[i])];
    std::size_t block = 0;
    if (group.columns > 1 || group.rows > 1) {
      const float time = places.t[i] - 0.5F;
      const float across = (places.x[i] - 0.5F - dx * time) * per_x + 0.5F;
      const float down = (places.y[i] - 0.5F - dy * time) * per_y + 0.5F;
      const int column = std::clamp(
          static_cast<int>(across * static_cast<float>(group.columns)), 0, group.columns - 1);
      const int row =
          std::clamp(static_cast<int>(down * static_cast<float>(group.rows)), 0, group.rows - 1);
      block = static_cast<std::size_t>(column * group.rows + row);
    }
    Piece& piece = block_[group.first + block];
    piece.middle[0] += places.x[i];
    piece.middle[1] += places.y[i];
    piece.middle[2] += places.t[i];
    piece.samples += 1;
  }
}

// Leaves the empty blocks out.
void Pieces::gather() {
  count_ = 0;
  for (std::size_t g = 0; g < groups_; ++g) {
    const Group& group = group_[g];
    const auto blocks = static_cast<std::size_t>(group.columns * group.rows);
    for (std::size_t b = group.first; b < group.first + blocks; ++b) {
      if (!(block_[b].samples > 0)) continue;
      Piece& piece = piece_[count_++] = block_[b];
      for (float& mean : piece.middle) mean /= piece.samples;
    }
  }
}

}  // namespace airtruth::render
