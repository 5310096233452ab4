// SPDX-License-Identifier: Apache-2.0
#include "world/synthetic/land.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/parallel_for.h>

namespace airtruth::synthetic {
namespace {

// Cells of the slowly varying map along each side.
constexpr int kSlow = 512;
// Texels of the mottling along each side.
constexpr int kSoil = 1024;
constexpr float kSoil_m = 1.25F;

// Colours of a dry plateau in late summer.
const std::array<LinearRgb, 9> kCrops = {linear_rgb(0.46F, 0.36F, 0.20F),
                                         linear_rgb(0.52F, 0.43F, 0.26F),
                                         linear_rgb(0.40F, 0.31F, 0.18F),
                                         linear_rgb(0.27F, 0.18F, 0.11F),
                                         linear_rgb(0.33F, 0.23F, 0.14F),
                                         linear_rgb(0.12F, 0.16F, 0.055F),
                                         linear_rgb(0.20F, 0.21F, 0.09F),
                                         linear_rgb(0.36F, 0.30F, 0.19F),
                                         linear_rgb(0.30F, 0.27F, 0.16F)};

}  // namespace

Land::Land(std::uint32_t seed)
    : slow_(std::size_t{kSlow} * kSlow), soil_(std::size_t{kSoil} * kSoil) {
  for (int y = 0; y < kBlocks; ++y)
    for (int x = 0; x < kBlocks; ++x) {
      const std::uint32_t id = hash(x, y, seed + 3);
      const float angle = 3.14159F * unit(mix(id + 1));
      centres_[static_cast<std::size_t>(y * kBlocks + x)] = {id,
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
      soil_[static_cast<std::size_t>(row * kSoil + column)] = {
          fractal(x * 16, y * 16, 3, 16, seed + 11), fractal(x * 128, y * 128, 2, 128, seed + 12)};
    }
  });
}

LinearRgb Land::slow(float north_m, float east_m) const {
  const float x = north_m * (kSlow / kLand_m);
  const float y = east_m * (kSlow / kLand_m);
  const int ix = floor_int(x);
  const int iy = floor_int(y);
  const auto at = [&](int i, int j) -> const LinearRgb& {
    return slow_[static_cast<std::size_t>(((iy + j) & (kSlow - 1)) * kSlow +
                                          ((ix + i) & (kSlow - 1)))];
  };
  const float fx = x - static_cast<float>(ix);
  const float fy = y - static_cast<float>(iy);
  return (at(0, 0) * (1 - fx) + at(1, 0) * fx) * (1 - fy) +
         (at(0, 1) * (1 - fx) + at(1, 1) * fx) * fy;
}

// Blocks of fields: the cells of a jittered grid (Worley 1996) with slightly bent borders.
Land::Block Land::block(float north_m, float east_m, const LinearRgb& slow) const {
  constexpr float kBlock_m = kLand_m / kBlocks;
  const float x = north_m / kBlock_m + slow[0];
  const float y = east_m / kBlock_m + slow[1];
  const int cx = floor_int(x);
  const int cy = floor_int(y);
  const float fx = x - static_cast<float>(cx);
  const float fy = y - static_cast<float>(cy);
  float nearest = 1e9F;
  float second = 1e9F;
  Block best;
  const Centre* other = nullptr;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      const Centre& centre = centres_[static_cast<std::size_t>(
          ((cy + j) & (kBlocks - 1)) * kBlocks + ((cx + i) & (kBlocks - 1)))];
      const float dx = fx - static_cast<float>(i) - centre.north;
      const float dy = fy - static_cast<float>(j) - centre.east;
      const float d = dx * dx + dy * dy;
      if (d < nearest) {
        second = nearest;
        other = best.centre;
        nearest = d;
        best.centre = &centre;
        best.north_m = dx * kBlock_m;
        best.east_m = dy * kBlock_m;
      } else if (d < second) {
        second = d;
        other = &centre;
      }
    }
  best.edge_m = 0.5F * (std::sqrt(second) - std::sqrt(nearest)) * kBlock_m;
  best.border = mix(best.centre->id ^ other->id);
  return best;
}

// Strips along the block's own direction, divided into parcels, each with its crop and its lines of
// sowing.
LinearRgb Land::crop(const Block& block, float north_m, float east_m) const {
  const Centre& centre = *block.centre;
  const float width = centre.width_m;
  const float u = centre.cosine * block.north_m + centre.sine * block.east_m;
  const float v = -centre.sine * block.north_m + centre.cosine * block.east_m;
  const int i = floor_int(u / width);
  const std::uint32_t strip = hash(i, 7, centre.id);
  const int j = floor_int(v / centre.length_m + unit(strip));
  const std::uint32_t id = hash(i, j, centre.id);
  LinearRgb colour = kCrops[id % kCrops.size()] * (0.85F + 0.3F * unit(mix(id + 1)));
  const int sx = floor_int(north_m / kSoil_m) & (kSoil - 1);
  const int sy = floor_int(east_m / kSoil_m) & (kSoil - 1);
  const auto [coarse, fine] = soil_[static_cast<std::size_t>(sy * kSoil + sx)];
  colour *= 0.62F + 0.45F * coarse + 0.3F * fine;
  const float spacing = 5 + 9 * unit(mix(id + 2));
  const float rows = 0.10F * unit(mix(id + 3));
  colour *= 1 + rows * std::cos(6.2832F * u / spacing);
  const float side = u - static_cast<float>(i) * width;
  const float margin_m = std::min(side, width - side) - 1.2F * fine;
  const LinearRgb grass = linear_rgb(0.27F, 0.245F, 0.12F) * (0.7F + 0.6F * fine);
  return colour + (grass - colour) * smoothstep(1.8F, 0.6F, margin_m);
}

Place Land::at(float north_m, float east_m) const {
  Place place;
  const LinearRgb far = slow(north_m, east_m);
  const Block here = block(north_m, east_m, far);
  place.albedo = crop(here, north_m, east_m);
  place.field = true;
  place.track_m = here.edge_m;
  place.hedge = (here.border >> 4) % 5 == 0;
  const bool road = here.border % 5 == 1;
  const float half_m = road ? 4.0F : 2.2F;
  const LinearRgb surface =
      road ? linear_rgb(0.24F, 0.235F, 0.23F) : linear_rgb(0.56F, 0.47F, 0.34F);
  const LinearRgb verge = linear_rgb(0.30F, 0.26F, 0.14F);
  place.albedo += (verge - place.albedo) * smoothstep(half_m + 3.5F, half_m + 1, here.edge_m);
  place.albedo += (surface - place.albedo) * smoothstep(half_m + 0.9F, half_m - 0.9F, here.edge_m);

  place.wood = smoothstep(0.585F, 0.625F, far[2]);
  if (place.wood > 0 && here.edge_m > half_m) {
    const LinearRgb floor = linear_rgb(0.16F, 0.14F, 0.075F);
    place.albedo += (floor - place.albedo) * place.wood;
    place.field = place.field && place.wood < 0.3F;
  }
  place.river_m = std::abs(far[3] - 0.47F) * 5200;
  if (place.river_m < 60) {
    const LinearRgb bank = linear_rgb(0.13F, 0.15F, 0.06F);
    place.albedo += (bank - place.albedo) * smoothstep(60.0F, 22.0F, place.river_m);
    const LinearRgb water = linear_rgb(0.12F, 0.15F, 0.155F);
    place.albedo += (water - place.albedo) * smoothstep(13.0F, 10.0F, place.river_m);
    place.field = place.field && place.river_m > 45;
  }
  return place;
}

}  // namespace airtruth::synthetic
