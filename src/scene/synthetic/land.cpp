// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/land.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/parallel_for.h>

namespace airtruth::synthetic {
namespace {

// Where a constant of this file states no origin, it is a choice: the world is invented.

// Cells of the slowly varying map along each side.
constexpr int kSlow = 512;
// Number of texels of the mottling along each side, and the side of one.
constexpr int kSoil = 1024;
constexpr float kSoil_m = 1.25F;

// Albedos of nine crops, ratios: the colours of a dry plateau in late summer.
constexpr int kCrops = 9;
constexpr float kCropRed[kCrops] = {0.46F, 0.52F, 0.40F, 0.27F, 0.33F, 0.12F, 0.20F, 0.36F, 0.30F};
constexpr float kCropGreen[kCrops] = {
    0.36F, 0.43F, 0.31F, 0.18F, 0.23F, 0.16F, 0.21F, 0.30F, 0.27F};
constexpr float kCropBlue[kCrops] = {
    0.20F, 0.26F, 0.18F, 0.11F, 0.14F, 0.055F, 0.09F, 0.19F, 0.16F};

// Blends a colour into the ground's by shares, 0 to 1.
inline void blend(Light& ground, int i, float red, float green, float blue, float share) {
  ground.red[i] += (red - ground.red[i]) * share;
  ground.green[i] += (green - ground.green[i]) * share;
  ground.blue[i] += (blue - ground.blue[i]) * share;
}

// The search for the nearest centre of a block and for the second nearest; in blocks.
struct Nearest {
  alignas(64) Floats x;
  alignas(64) Floats y;
  // From the nearest centre.
  alignas(64) Floats dx;
  alignas(64) Floats dy;
  alignas(64) Floats square;
  alignas(64) Floats second_square;
  alignas(64) Integers centre;
  alignas(64) Integers second;
};

struct Cell {
  int x, y;
};

// Compares the distances with those to the centre of a neighbouring cell.
AIRTRUTH_FOR_VECTORS
void compare(const float* __restrict north,
             const float* __restrict east,
             int blocks,
             const Cell& cell,
             int count,
             Nearest& __restrict nearest) {
  const Cell step = cell;
  for (int k = 0; k < count; ++k) {
    const int cx = floor_int(nearest.x[k]);
    const int cy = floor_int(nearest.y[k]);
    const int centre = ((cy + step.y) & (blocks - 1)) * blocks + ((cx + step.x) & (blocks - 1));
    const float fx = nearest.x[k] - static_cast<float>(cx);
    const float fy = nearest.y[k] - static_cast<float>(cy);
    const float dx = fx - static_cast<float>(step.x) - north[centre];
    const float dy = fy - static_cast<float>(step.y) - east[centre];
    const float square = dx * dx + dy * dy;
    const bool closer = square < nearest.square[k];
    const bool between = square < nearest.second_square[k];
    nearest.second_square[k] =
        closer ? nearest.square[k] : (between ? square : nearest.second_square[k]);
    nearest.second[k] = closer ? nearest.centre[k] : (between ? centre : nearest.second[k]);
    nearest.square[k] = closer ? square : nearest.square[k];
    nearest.centre[k] = closer ? centre : nearest.centre[k];
    nearest.dx[k] = closer ? dx : nearest.dx[k];
    nearest.dy[k] = closer ? dy : nearest.dy[k];
  }
}

// Roads and tracks along the borders of the blocks, with their verges.
AIRTRUTH_FOR_VECTORS
void add_tracks(const Integers& borders, Places& __restrict places) {
  const int count = places.count;
  for (int i = 0; i < count; ++i) {
    const auto border = static_cast<std::uint32_t>(borders[i]);
    places.hedge[i] = (border >> 4) % 5 == 0 ? 1 : 0;
    const bool road = border % 5 == 1;
    const float half_m = road ? 4.0F : 2.2F;
    const float edge_m = places.track_m[i];
    blend(places.albedo, i, 0.30F, 0.26F, 0.14F, smoothstep(half_m + 3.5F, half_m + 1, edge_m));
    blend(places.albedo,
          i,
          road ? 0.24F : 0.56F,
          road ? 0.235F : 0.47F,
          road ? 0.23F : 0.34F,
          smoothstep(half_m + 0.9F, half_m - 0.9F, edge_m));
    // The floor of the woods, which tracks cross.
    const float wood = places.wood[i];
    const float floor = edge_m > half_m ? wood : 0.0F;
    blend(places.albedo, i, 0.16F, 0.14F, 0.075F, floor);
    places.field[i] = ((floor <= 0) | (wood < 0.3F)) ? 1 : 0;
  }
}

// The river and its banks.
AIRTRUTH_FOR_VECTORS
void add_river(Places& __restrict places) {
  const int count = places.count;
  for (int i = 0; i < count; ++i) {
    const float river_m = places.river_m[i];
    blend(places.albedo, i, 0.13F, 0.15F, 0.06F, smoothstep(60.0F, 22.0F, river_m));
    blend(places.albedo, i, 0.12F, 0.15F, 0.155F, smoothstep(13.0F, 10.0F, river_m));
    places.field[i] = river_m > 45 ? places.field[i] : 0;
  }
}

}  // namespace

Land::Land(std::uint32_t seed)
    : slow_(std::size_t{kSlow} * kSlow),
      coarse_soil_(std::size_t{kSoil} * kSoil),
      fine_soil_(coarse_soil_.size()) {
  for (int y = 0; y < kBlocks; ++y)
    for (int x = 0; x < kBlocks; ++x) {
      const std::uint32_t id = hash(x, y, seed + 3);
      const float angle = 3.14159F * unit(mix(id + 1));
      const auto i = static_cast<std::size_t>(y * kBlocks + x);
      centres_.id[i] = id;
      centres_.north[i] = 0.15F + 0.7F * unit(id);
      centres_.east[i] = 0.15F + 0.7F * unit(mix(id));
      centres_.cosine[i] = std::cos(angle);
      centres_.sine[i] = std::sin(angle);
      centres_.width_m[i] = 38 + 75 * unit(mix(id + 2));
      centres_.length_m[i] = 170 + 260 * unit(mix(id + 3));
    }
  tbb::parallel_for(0, kSlow, [&](int row) {
    for (int column = 0; column < kSlow; ++column) {
      const float x = static_cast<float>(column) / kSlow;
      const float y = static_cast<float>(row) / kSlow;
      slow_[static_cast<std::size_t>(row * kSlow + column)] = {
          0.22F * (value_noise(x * 16, y * 16, 16, seed + 1) - 0.5F),
          0.22F * (value_noise(x * 16, y * 16, 16, seed + 2) - 0.5F),
          fractal(x * 4, y * 4, 6, 4, seed + 21),
          fractal(x * 2, y * 2, 4, 2, seed + 31)};
    }
  });
  tbb::parallel_for(0, kSoil, [&](int row) {
    for (int column = 0; column < kSoil; ++column) {
      const float x = static_cast<float>(column) / kSoil;
      const float y = static_cast<float>(row) / kSoil;
      const auto i = static_cast<std::size_t>(row * kSoil + column);
      coarse_soil_[i] = fractal(x * 16, y * 16, 3, 16, seed + 11);
      fine_soil_[i] = fractal(x * 128, y * 128, 2, 128, seed + 12);
    }
  });
}

void Land::read_slow_map(const Places& places, Work& work) const {
  for (int k = 0; k < places.count; ++k) {
    const float x = places.north_m[k] * (kSlow / kLand_m);
    const float y = places.east_m[k] * (kSlow / kLand_m);
    const int ix = floor_int(x);
    const int iy = floor_int(y);
    const auto at = [&](int i, int j) -> const LinearRgb& {
      return slow_[static_cast<std::size_t>(((iy + j) & (kSlow - 1)) * kSlow +
                                            ((ix + i) & (kSlow - 1)))];
    };
    const float fx = x - static_cast<float>(ix);
    const float fy = y - static_cast<float>(iy);
    const LinearRgb slow = (at(0, 0) * (1 - fx) + at(1, 0) * fx) * (1 - fy) +
                           (at(0, 1) * (1 - fx) + at(1, 1) * fx) * fy;
    work.bend_north[k] = slow[0];
    work.bend_east[k] = slow[1];
    work.woods[k] = slow[2];
    work.height[k] = slow[3];
  }
}

// Blocks of fields: the cells of a jittered grid (Worley 1996) with slightly bent borders.
void Land::find_blocks(Places& places, Work& work) const {
  // Side of a block.
  constexpr float kBlock_m = kLand_m / kBlocks;
  Nearest nearest;
  for (int k = 0; k < places.count; ++k) {
    nearest.x[k] = places.north_m[k] / kBlock_m + work.bend_north[k];
    nearest.y[k] = places.east_m[k] / kBlock_m + work.bend_east[k];
    nearest.square[k] = 1e9F;
    nearest.second_square[k] = 1e9F;
    nearest.centre[k] = 0;
    nearest.second[k] = 0;
  }
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i)
      compare(centres_.north.data(), centres_.east.data(), kBlocks, {i, j}, places.count, nearest);
  for (int k = 0; k < places.count; ++k) {
    work.block[k] = nearest.centre[k];
    work.neighbour[k] = nearest.second[k];
    work.north_m[k] = nearest.dx[k] * kBlock_m;
    work.east_m[k] = nearest.dy[k] * kBlock_m;
    places.track_m[k] =
        0.5F * (std::sqrt(nearest.second_square[k]) - std::sqrt(nearest.square[k])) * kBlock_m;
  }
}

AIRTRUTH_FOR_VECTORS
void Land::find_borders(Places& __restrict places, Work& __restrict work) const {
  const std::uint32_t* id = centres_.id.data();
  const int count = places.count;
  for (int k = 0; k < count; ++k) {
    work.border[k] = static_cast<std::int32_t>(mix(id[work.block[k]] ^ id[work.neighbour[k]]));
    places.wood[k] = smoothstep(0.585F, 0.625F, work.woods[k]);
    places.river_m[k] = std::abs(work.height[k] - 0.47F) * 5200;
  }
}

// Strips along the block's own direction, divided into parcels.
AIRTRUTH_FOR_VECTORS
void Land::find_parcels(const Places& places, Work& __restrict work) const {
  const std::uint32_t* id = centres_.id.data();
  const float* cosine = centres_.cosine.data();
  const float* sine = centres_.sine.data();
  const float* width_m = centres_.width_m.data();
  const float* length_m = centres_.length_m.data();
  const int count = places.count;
  for (int k = 0; k < count; ++k) {
    const std::int32_t block = work.block[k];
    const float u = cosine[block] * work.north_m[k] + sine[block] * work.east_m[k];
    const float v = -sine[block] * work.north_m[k] + cosine[block] * work.east_m[k];
    const float width = width_m[block];
    const int i = floor_int(u / width);
    const std::uint32_t strip = hash(i, 7, id[block]);
    const int j = floor_int(v / length_m[block] + unit(strip));
    const float side = u - static_cast<float>(i) * width;
    work.parcel[k] = static_cast<std::int32_t>(hash(i, j, id[block]));
    work.across_m[k] = u;
    work.margin_m[k] = std::min(side, width - side);
  }
}

// Each parcel has its crop and its lines of sowing.
AIRTRUTH_FOR_VECTORS
void Land::sow(const Work& work, Places& __restrict places) const {
  const float* coarse_soil = coarse_soil_.data();
  const float* fine_soil = fine_soil_.data();
  const int count = places.count;
  for (int k = 0; k < count; ++k) {
    const auto id = static_cast<std::uint32_t>(work.parcel[k]);
    const auto crop = static_cast<std::int32_t>(id % kCrops);
    const float tone = 0.85F + 0.3F * unit(mix(id + 1));
    const int sx = floor_int(places.north_m[k] / kSoil_m) & (kSoil - 1);
    const int sy = floor_int(places.east_m[k] / kSoil_m) & (kSoil - 1);
    const float coarse = coarse_soil[sy * kSoil + sx];
    const float fine = fine_soil[sy * kSoil + sx];
    const float soil = 0.62F + 0.45F * coarse + 0.3F * fine;
    const float spacing = 5 + 9 * unit(mix(id + 2));
    const float depth = 0.10F * unit(mix(id + 3));
    const float row = 1 + depth * cosine_of(6.2832F * work.across_m[k] / spacing);
    const float grass = 0.7F + 0.6F * fine;
    const float margin = smoothstep(1.8F, 0.6F, work.margin_m[k] - 1.2F * fine);
    places.albedo.red[k] = kCropRed[crop] * tone * soil * row;
    places.albedo.green[k] = kCropGreen[crop] * tone * soil * row;
    places.albedo.blue[k] = kCropBlue[crop] * tone * soil * row;
    blend(places.albedo, k, 0.27F * grass, 0.245F * grass, 0.12F * grass, margin);
  }
}

void Land::cover(Places& places) const {
  Work work;
  read_slow_map(places, work);
  find_blocks(places, work);
  find_borders(places, work);
  find_parcels(places, work);
  sow(work, places);
  add_tracks(work.border, places);
  add_river(places);
}

}  // namespace airtruth::synthetic
