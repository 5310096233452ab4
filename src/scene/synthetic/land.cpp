// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/land.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/parallel_for.h>

namespace airtruth::synthetic {
namespace {

constexpr int kBlocks = 8;
constexpr float kBlock_m = kLand_m / kBlocks;
constexpr int kSlow = 512;
constexpr int kSoil = 1024;
constexpr float kSoil_m = 1.25F;

// Colours of the crops of a dry plateau in late summer.
const std::array<LinearRgb, 9>& crops() {
  static const std::array<LinearRgb, 9> colours = {linear_rgb(0.46F, 0.36F, 0.20F),
                                                   linear_rgb(0.52F, 0.43F, 0.26F),
                                                   linear_rgb(0.40F, 0.31F, 0.18F),
                                                   linear_rgb(0.27F, 0.18F, 0.11F),
                                                   linear_rgb(0.33F, 0.23F, 0.14F),
                                                   linear_rgb(0.12F, 0.16F, 0.055F),
                                                   linear_rgb(0.20F, 0.21F, 0.09F),
                                                   linear_rgb(0.36F, 0.30F, 0.19F),
                                                   linear_rgb(0.30F, 0.27F, 0.16F)};
  return colours;
}

void blend(LinearRgb& ground, const LinearRgb& colour, float share) {
  ground += (colour - ground) * share;
}

// Roads and tracks along the borders of the blocks, with their verges, and the floor of the woods,
// which tracks cross.
void add_track(std::uint32_t border, Cover& cover) {
  cover.hedge = (border >> 4) % 5 == 0;
  const bool road = border % 5 == 1;
  const float half_m = road ? 4.0F : 2.2F;
  blend(cover.albedo,
        linear_rgb(0.30F, 0.26F, 0.14F),
        smoothstep(half_m + 3.5F, half_m + 1, cover.track_m));
  blend(cover.albedo,
        road ? linear_rgb(0.24F, 0.235F, 0.23F) : linear_rgb(0.56F, 0.47F, 0.34F),
        smoothstep(half_m + 0.9F, half_m - 0.9F, cover.track_m));
  const float floor = cover.track_m > half_m ? cover.wood : 0.0F;
  blend(cover.albedo, linear_rgb(0.16F, 0.14F, 0.075F), floor);
  cover.field = floor <= 0 || cover.wood < 0.3F;
}

// The river and its banks.
void add_river(Cover& cover) {
  blend(cover.albedo, linear_rgb(0.13F, 0.15F, 0.06F), smoothstep(60.0F, 22.0F, cover.river_m));
  blend(cover.albedo, linear_rgb(0.12F, 0.15F, 0.155F), smoothstep(13.0F, 10.0F, cover.river_m));
  cover.field = cover.field && cover.river_m > 45;
}

}  // namespace

Land::Land(std::uint32_t seed)
    : blocks_(kBlocks), slow_(kSlow), coarse_soil_(kSoil), fine_soil_(kSoil) {
  for (int y = 0; y < kBlocks; ++y)
    for (int x = 0; x < kBlocks; ++x) {
      const std::uint32_t id = hash(x, y, seed + 3);
      const float angle = 3.14159F * unit(mix(id + 1));
      blocks_.at(x, y) = {id,
                          0.15F + 0.7F * unit(id),
                          0.15F + 0.7F * unit(mix(id)),
                          std::cos(angle),
                          std::sin(angle),
                          38 + 75 * unit(mix(id + 2)),
                          170 + 260 * unit(mix(id + 3))};
    }
  tbb::parallel_for(0, kSlow, [&](int row) {
    for (int column = 0; column < kSlow; ++column) {
      const float x = static_cast<float>(column) / kSlow;
      const float y = static_cast<float>(row) / kSlow;
      slow_.at(column, row) = {0.22F * (value_noise(x * 16, y * 16, 16, seed + 1) - 0.5F),
                               0.22F * (value_noise(x * 16, y * 16, 16, seed + 2) - 0.5F),
                               fractal(x * 4, y * 4, 6, 4, seed + 21),
                               fractal(x * 2, y * 2, 4, 2, seed + 31)};
    }
  });
  tbb::parallel_for(0, kSoil, [&](int row) {
    for (int column = 0; column < kSoil; ++column) {
      const float x = static_cast<float>(column) / kSoil;
      const float y = static_cast<float>(row) / kSoil;
      coarse_soil_.at(column, row) = fractal(x * 16, y * 16, 3, 16, seed + 11);
      fine_soil_.at(column, row) = fractal(x * 128, y * 128, 2, 128, seed + 12);
    }
  });
}

Land::Nearest Land::nearest(float north, float east) const {
  const int cell_x = floor_int(north);
  const int cell_y = floor_int(east);
  const float x = north - static_cast<float>(cell_x);
  const float y = east - static_cast<float>(cell_y);
  Nearest best;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      const Block& block = blocks_.at(cell_x + i, cell_y + j);
      const float dx = x - static_cast<float>(i) - block.north;
      const float dy = y - static_cast<float>(j) - block.east;
      const float square = dx * dx + dy * dy;
      if (square < best.square)
        best = {&block, best.block, dx, dy, square, best.square};
      else if (square < best.second_square)
        best.neighbour = &block, best.second_square = square;
    }
  return best;
}

// The parcel of a strip at the place: its crop in lines of sowing, and the grass along its margins.
LinearRgb Land::parcel(float north_m, float east_m, const Nearest& nearest) const {
  const Block& block = *nearest.block;
  const float across_m = (block.cosine * nearest.north + block.sine * nearest.east) * kBlock_m;
  const float along_m = (-block.sine * nearest.north + block.cosine * nearest.east) * kBlock_m;
  const int i = floor_int(across_m / block.width_m);
  const int j = floor_int(along_m / block.length_m + unit(hash(i, 7, block.id)));
  const float side_m = across_m - static_cast<float>(i) * block.width_m;
  const std::uint32_t id = hash(i, j, block.id);
  const int x = floor_int(north_m / kSoil_m);
  const int y = floor_int(east_m / kSoil_m);
  const float fine = fine_soil_.at(x, y);
  const float soil = 0.62F + 0.45F * coarse_soil_.at(x, y) + 0.3F * fine;
  const float tone = 0.85F + 0.3F * unit(mix(id + 1));
  const float spacing_m = 5 + 9 * unit(mix(id + 2));
  const float row = 1 + 0.10F * unit(mix(id + 3)) * std::cos(6.2832F * across_m / spacing_m);
  LinearRgb colour = crops()[id % crops().size()] * (tone * soil * row);
  blend(colour,
        linear_rgb(0.27F, 0.245F, 0.12F) * (0.7F + 0.6F * fine),
        smoothstep(1.8F, 0.6F, std::min(side_m, block.width_m - side_m) - 1.2F * fine));
  return colour;
}

Cover Land::at(float north_m, float east_m) const {
  const LinearRgb slow = slow_.between(north_m * (kSlow / kLand_m), east_m * (kSlow / kLand_m));
  const Nearest block = nearest(north_m / kBlock_m + slow[0], east_m / kBlock_m + slow[1]);
  Cover cover;
  cover.albedo = parcel(north_m, east_m, block);
  cover.wood = smoothstep(0.585F, 0.625F, slow[2]);
  cover.track_m = 0.5F * (std::sqrt(block.second_square) - std::sqrt(block.square)) * kBlock_m;
  cover.river_m = std::abs(slow[3] - 0.47F) * 5200;
  // The identifier of the border is the same on both sides.
  add_track(mix(block.block->id ^ block.neighbour->id), cover);
  add_river(cover);
  return cover;
}

}  // namespace airtruth::synthetic
