// SPDX-License-Identifier: Apache-2.0
#include "synthetic/land.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace airtruth::synthetic {
namespace {

constexpr int kBlocks = 8;  // along each side of the land
constexpr float kBlock_m = kLand_m / kBlocks;

// Late summer on a dry plateau.
const std::array<Light, 9> kCrops = {light(0.46F, 0.36F, 0.20F),
                                     light(0.52F, 0.43F, 0.26F),
                                     light(0.40F, 0.31F, 0.18F),
                                     light(0.27F, 0.18F, 0.11F),
                                     light(0.33F, 0.23F, 0.14F),
                                     light(0.12F, 0.16F, 0.055F),
                                     light(0.20F, 0.21F, 0.09F),
                                     light(0.36F, 0.30F, 0.19F),
                                     light(0.30F, 0.27F, 0.16F)};

}  // namespace

// Blocks of fields: the cells of a jittered grid (Worley 1996), their borders bent a little.
Land::Block Land::block(float north_m, float east_m) const {
  const float x =
      north_m / kBlock_m + 0.22F * (value_noise(north_m / 320, east_m / 320, 16, seed_ + 1) - 0.5F);
  const float y =
      east_m / kBlock_m + 0.22F * (value_noise(north_m / 320, east_m / 320, 16, seed_ + 2) - 0.5F);
  const int cx = floor_int(x);
  const int cy = floor_int(y);
  float nearest = 1e9F;
  float second = 1e9F;
  Block best;
  std::uint32_t other = 0;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      const std::uint32_t id = hash((cx + i) & (kBlocks - 1), (cy + j) & (kBlocks - 1), seed_ + 3);
      const float dx = x - static_cast<float>(cx + i) - 0.15F - 0.7F * unit(id);
      const float dy = y - static_cast<float>(cy + j) - 0.15F - 0.7F * unit(mix(id));
      const float d = dx * dx + dy * dy;
      if (d < nearest) {
        second = nearest;
        other = best.id;
        nearest = d;
        best.id = id;
        best.north = dx * kBlock_m;
        best.east = dy * kBlock_m;
      } else if (d < second) {
        second = d;
        other = id;
      }
    }
  best.edge_m = 0.5F * (std::sqrt(second) - std::sqrt(nearest)) * kBlock_m;
  best.border = mix(best.id ^ other);
  return best;
}

// Strips along the block's own direction, cut into parcels, each with its crop and the lines of its
// sowing.
Light Land::crop(const Block& block, float north_m, float east_m) const {
  const float angle = 3.14159F * unit(mix(block.id + 1));
  const float c = std::cos(angle);
  const float s = std::sin(angle);
  const float width = 38 + 75 * unit(mix(block.id + 2));
  const float length = 170 + 260 * unit(mix(block.id + 3));
  const float u = c * block.north + s * block.east;
  const float v = -s * block.north + c * block.east;
  const int i = floor_int(u / width);
  const std::uint32_t strip = hash(i, 7, block.id);
  const int j = floor_int(v / length + unit(strip));
  const std::uint32_t id = hash(i, j, block.id);
  Light colour = kCrops[id % kCrops.size()] * (0.85F + 0.3F * unit(mix(id + 1)));
  const float coarse = fractal(north_m / 80, east_m / 80, 3, 64, seed_ + 11);
  const float fine = fractal(north_m / 10, east_m / 10, 2, 512, seed_ + 12);
  colour *= 0.62F + 0.45F * coarse + 0.3F * fine;
  const float spacing = 5 + 9 * unit(mix(id + 2));
  const float rows = 0.10F * unit(mix(id + 3));
  colour *= 1 + rows * std::cos(6.2832F * u / spacing);
  const float side = u - static_cast<float>(i) * width;
  const float margin_m = std::min(side, width - side) - 1.2F * fine;
  const Light grass = light(0.27F, 0.245F, 0.12F) * (0.7F + 0.6F * fine);
  return colour + (grass - colour) * smoothstep(1.8F, 0.6F, margin_m);
}

Place Land::at(float north_m, float east_m) const {
  Place place;
  const Block here = block(north_m, east_m);
  place.albedo = crop(here, north_m, east_m);
  place.field = true;
  place.track_m = here.edge_m;
  place.hedge = (here.border >> 4) % 5 == 0;
  const bool road = here.border % 5 == 1;
  const float half_m = road ? 4.0F : 2.2F;
  const Light surface = road ? light(0.24F, 0.235F, 0.23F) : light(0.56F, 0.47F, 0.34F);
  const Light verge = light(0.30F, 0.26F, 0.14F);
  place.albedo += (verge - place.albedo) * smoothstep(half_m + 3.5F, half_m + 1, here.edge_m);
  place.albedo += (surface - place.albedo) * smoothstep(half_m + 0.9F, half_m - 0.9F, here.edge_m);

  const float woods = fractal(north_m / 1280, east_m / 1280, 5, 4, seed_ + 21);
  place.wood = smoothstep(0.585F, 0.625F, woods);
  if (place.wood > 0 && here.edge_m > half_m) {
    const Light floor = light(0.16F, 0.14F, 0.075F);
    place.albedo += (floor - place.albedo) * place.wood;
    place.field = place.field && place.wood < 0.3F;
  }
  const float height = fractal(north_m / 2560, east_m / 2560, 4, 2, seed_ + 31);
  place.river_m = std::abs(height - 0.47F) * 5200;
  if (place.river_m < 60) {
    const Light bank = light(0.13F, 0.15F, 0.06F);
    place.albedo += (bank - place.albedo) * smoothstep(60.0F, 22.0F, place.river_m);
    const Light water = light(0.12F, 0.15F, 0.155F);
    place.albedo += (water - place.albedo) * smoothstep(13.0F, 10.0F, place.river_m);
    place.field = place.field && place.river_m > 45;
  }
  return place;
}

}  // namespace airtruth::synthetic
