// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/land.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <tbb/parallel_for.h>

#include "scene/synthetic/rays.h"

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

// Calls step(0) to step(count - 1) in a row without a loop: the compiler makes vectors only of
// loops that hold no other loop.
template <int count, typename Step>
[[gnu::always_inline]] inline void unrolled(const Step& step) {
  [&]<int... index>(std::integer_sequence<int, index...>) __attribute__((always_inline)) {
    (step(index), ...);
  }
  (std::make_integer_sequence<int, count>{});
}

// The colour of the ground.
struct Cover {
  float red, green, blue;
  // Blends a colour into it by a share, 0 to 1.
  [[gnu::always_inline]] void blend(float r, float g, float b, float share) {
    red += (r - red) * share;
    green += (g - green) * share;
    blue += (b - blue) * share;
  }
};

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
    PlaneNoise north_bend(16, seed + 1), east_bend(16, seed + 2);
    auto wood = fractal<6>(4, seed + 21);
    auto river = fractal<4>(2, seed + 31);
    for (int column = 0; column < kSlow; ++column) {
      const float x = static_cast<float>(column) / kSlow;
      const float y = static_cast<float>(row) / kSlow;
      slow_[static_cast<std::size_t>(row * kSlow + column)] = {
          0.22F * (north_bend.at(x * 16, y * 16) - 0.5F),
          0.22F * (east_bend.at(x * 16, y * 16) - 0.5F),
          wood.at(x * 4, y * 4),
          river.at(x * 2, y * 2)};
    }
  });
  tbb::parallel_for(0, kSoil, [&](int row) {
    auto coarse = fractal<3>(16, seed + 11);
    auto fine = fractal<2>(128, seed + 12);
    for (int column = 0; column < kSoil; ++column) {
      const float x = static_cast<float>(column) / kSoil;
      const float y = static_cast<float>(row) / kSoil;
      const auto i = static_cast<std::size_t>(row * kSoil + column);
      coarse_soil_[i] = coarse.at(x * 16, y * 16);
      fine_soil_[i] = fine.at(x * 128, y * 128);
    }
  });
}

// Finds the blocks of fields: the cells of a jittered grid (Worley 1996) with slightly bent
// borders.
AIRTRUTH_FOR_VECTORS
void Land::find_blocks(Places& __restrict places, Blocks& __restrict blocks) const {
  // Side of a block.
  constexpr float kBlock_m = kLand_m / kBlocks;
  const float* slow = slow_.data()->data();
  const float* north = centres_.north.data();
  const float* east = centres_.east.data();
  const int count = places.count;
  for (int k = 0; k < count; ++k) {
    // The bend of the borders (two), woods and height, from a coarse map.
    const float sx = places.north_m[k] * (kSlow / kLand_m);
    const float sy = places.east_m[k] * (kSlow / kLand_m);
    const int ix = floor_int(sx);
    const int iy = floor_int(sy);
    const float right = sx - static_cast<float>(ix);
    const float lower = sy - static_cast<float>(iy);
    const auto slow_at = [&](int part) __attribute__((always_inline)) {
      const auto at = [&](int i, int j) __attribute__((always_inline)) {
        return slow[(((iy + j) & (kSlow - 1)) * kSlow + ((ix + i) & (kSlow - 1))) * 4 + part];
      };
      return (at(0, 0) * (1 - right) + at(1, 0) * right) * (1 - lower) +
             (at(0, 1) * (1 - right) + at(1, 1) * right) * lower;
    };
    places.wood[k] = smoothstep(0.585F, 0.625F, slow_at(2));
    places.river_m[k] = std::abs(slow_at(3) - 0.47F) * 5200;
    // The nearest centre and the second nearest, in blocks.
    const float x = places.north_m[k] / kBlock_m + slow_at(0);
    const float y = places.east_m[k] / kBlock_m + slow_at(1);
    const int cx = floor_int(x);
    const int cy = floor_int(y);
    float dx = 0, dy = 0;
    float square = 1e9F, second_square = 1e9F;
    std::int32_t block = 0, second = 0;
    unrolled<9>([&](int cell) __attribute__((always_inline)) {
      const int i = cell % 3 - 1;
      const int j = cell / 3 - 1;
      const int centre = ((cy + j) & (kBlocks - 1)) * kBlocks + ((cx + i) & (kBlocks - 1));
      const float u = x - static_cast<float>(cx) - static_cast<float>(i) - north[centre];
      const float v = y - static_cast<float>(cy) - static_cast<float>(j) - east[centre];
      const float here = u * u + v * v;
      const bool closer = here < square;
      const bool between = here < second_square;
      second_square = closer ? square : (between ? here : second_square);
      second = closer ? block : (between ? centre : second);
      square = closer ? here : square;
      block = closer ? centre : block;
      dx = closer ? u : dx;
      dy = closer ? v : dy;
    });
    places.track_m[k] = 0.5F * (std::sqrt(second_square) - std::sqrt(square)) * kBlock_m;
    blocks.block[k] = block;
    blocks.neighbour[k] = second;
    blocks.north_m[k] = dx * kBlock_m;
    blocks.east_m[k] = dy * kBlock_m;
  }
}

// A block has strips along its own direction, divided into parcels; each of these has its crop and
// its lines of sowing.
AIRTRUTH_FOR_VECTORS
void Land::sow(const Blocks& blocks, Places& __restrict places) const {
  const std::uint32_t* ids = centres_.id.data();
  const float* cosine = centres_.cosine.data();
  const float* sine = centres_.sine.data();
  const float* strip_m = centres_.width_m.data();
  const float* parcel_m = centres_.length_m.data();
  const float* coarse_soil = coarse_soil_.data();
  const float* fine_soil = fine_soil_.data();
  const int count = places.count;
  for (int k = 0; k < count; ++k) {
    const std::int32_t block = blocks.block[k];
    const std::uint32_t id = ids[block];
    const float n = blocks.north_m[k];
    const float e = blocks.east_m[k];
    const float across_m = cosine[block] * n + sine[block] * e;
    const float along_m = -sine[block] * n + cosine[block] * e;
    const float width_m = strip_m[block];
    const int strip = floor_int(across_m / width_m);
    const int part = floor_int(along_m / parcel_m[block] + unit(hash(strip, 7, id)));
    const float side_m = across_m - static_cast<float>(strip) * width_m;
    const float margin_m = std::min(side_m, width_m - side_m);
    const std::uint32_t parcel = hash(strip, part, id);

    const auto crop = static_cast<std::int32_t>(parcel % kCrops);
    const float tone = 0.85F + 0.3F * unit(mix(parcel + 1));
    const int soil_at = (floor_int(places.east_m[k] / kSoil_m) & (kSoil - 1)) * kSoil +
                        (floor_int(places.north_m[k] / kSoil_m) & (kSoil - 1));
    const float fine = fine_soil[soil_at];
    const float soil = 0.62F + 0.45F * coarse_soil[soil_at] + 0.3F * fine;
    const float spacing = 5 + 9 * unit(mix(parcel + 2));
    const float depth = 0.10F * unit(mix(parcel + 3));
    const float row = 1 + depth * cosine_of(6.2832F * across_m / spacing);
    const float grass = 0.7F + 0.6F * fine;
    const float margin = smoothstep(1.8F, 0.6F, margin_m - 1.2F * fine);
    places.red[k] = lerp(kCropRed[crop] * tone * soil * row, 0.27F * grass, margin);
    places.green[k] = lerp(kCropGreen[crop] * tone * soil * row, 0.245F * grass, margin);
    places.blue[k] = lerp(kCropBlue[crop] * tone * soil * row, 0.12F * grass, margin);
  }
}

// Adds roads and tracks along the borders of the blocks, with their verges, and the river.
AIRTRUTH_FOR_VECTORS
void Land::cross(const Blocks& blocks, Places& __restrict places) const {
  const std::uint32_t* ids = centres_.id.data();
  const int count = places.count;
  for (int k = 0; k < count; ++k) {
    // The same on both sides of a border.
    const std::uint32_t border = mix(ids[blocks.block[k]] ^ ids[blocks.neighbour[k]]);
    const bool road = border % 5 == 1;
    const float track_m = places.track_m[k];
    const float river_m = places.river_m[k];
    const float half_m = road ? 4.0F : 2.2F;
    Cover cover{places.red[k], places.green[k], places.blue[k]};
    cover.blend(0.30F, 0.26F, 0.14F, smoothstep(half_m + 3.5F, half_m + 1, track_m));
    cover.blend(road ? 0.24F : 0.56F,
                road ? 0.235F : 0.47F,
                road ? 0.23F : 0.34F,
                smoothstep(half_m + 0.9F, half_m - 0.9F, track_m));
    // The floor of the woods, which tracks cross.
    const float wood = places.wood[k];
    const float floor = track_m > half_m ? wood : 0.0F;
    cover.blend(0.16F, 0.14F, 0.075F, floor);
    // The river and its banks.
    cover.blend(0.13F, 0.15F, 0.06F, smoothstep(60.0F, 22.0F, river_m));
    cover.blend(0.12F, 0.15F, 0.155F, smoothstep(13.0F, 10.0F, river_m));

    places.red[k] = cover.red;
    places.green[k] = cover.green;
    places.blue[k] = cover.blue;
    places.hedge[k] = (border >> 4) % 5 == 0 ? 1 : 0;
    const std::int32_t field = ((floor <= 0) | (wood < 0.3F)) ? 1 : 0;
    places.field[k] = river_m > 45 ? field : 0;
  }
}

void Land::cover(Places& places) const {
  Blocks blocks;
  find_blocks(places, blocks);
  sow(blocks, places);
  cross(blocks, places);
}

}  // namespace airtruth::synthetic
