// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include <tbb/parallel_for.h>

#include "scene/synthetic/ground.h"

// Paints the tile: first the land, then shadows, trees and houses over it.
namespace airtruth::synthetic {
namespace {

// Pitch of the grid of possible tree positions.
constexpr float kPlanting_m = 6.4F;

std::uint32_t pack(const LinearRgb& albedo, float height_m) {
  const auto byte = [](float x) { return static_cast<std::uint32_t>(clamp01(x) * 255 + 0.5F); };
  return byte(std::sqrt(albedo[0])) | byte(std::sqrt(albedo[1])) << 8 |
         byte(std::sqrt(albedo[2])) << 16 | byte(height_m / Ground::kHighest_m) << 24;
}

// The texels of bare ground.
AIRTRUTH_FOR_VECTORS
void pack_ground(const Places& places, Integers& __restrict packed) {
  const auto byte = [](float albedo) {
    return static_cast<std::int32_t>(clamp01(std::sqrt(albedo)) * 255 + 0.5F);
  };
  const int count = places.count;
  for (int k = 0; k < count; ++k)
    packed[k] = byte(places.albedo.red[k]) | byte(places.albedo.green[k]) << 8 |
                byte(places.albedo.blue[k]) << 16;
}

struct Tree {
  float north_m, east_m, radius_m, height_m;
  LinearRgb colour;
};

// The tree at a place, if one grows there; `id` is the place's random number.
std::optional<Tree> tree_at(const Places& places, int k, std::uint32_t id) {
  const float track_m = places.track_m[k];
  const float river_m = places.river_m[k];
  if (track_m < 4.5F || river_m < 11) return std::nullopt;
  float chance = 0.86F * places.wood[k] + (places.field[k] != 0 ? 0.0035F : 0.012F);
  if (river_m < 40) chance = std::max(chance, 0.75F * smoothstep(40.0F, 22.0F, river_m));
  if (places.hedge[k] != 0 && track_m < 11) chance = std::max(chance, 0.62F);
  if (unit(mix(id + 1)) >= chance) return std::nullopt;
  const float size = unit(mix(id + 2));
  const LinearRgb green =
      lerp(0.75F, 1.35F, unit(mix(id + 3))) * linear_rgb(0.062F, 0.082F, 0.030F);
  return Tree{places.north_m[k], places.east_m[k], 2.0F + 2.6F * size, 4.0F + 6.5F * size, green};
}

// The trees of all planting cells, row by row.
std::vector<std::vector<Tree>> trees_on(const Land& land, std::uint32_t seed) {
  const int cells = static_cast<int>(kLand_m / kPlanting_m);
  std::vector<std::vector<Tree>> rows(static_cast<std::size_t>(cells));
  tbb::parallel_for(0, cells, [&](int j) {
    Places places;
    for (int first = 0; first < cells; first += kBatch) {
      places.count = std::min(kBatch, cells - first);
      for (int k = 0; k < places.count; ++k) {
        const int i = first + k;
        const std::uint32_t id = hash(i, j, seed);
        places.north_m[k] = (static_cast<float>(i) + unit(id)) * kPlanting_m;
        places.east_m[k] = (static_cast<float>(j) + unit(mix(id))) * kPlanting_m;
      }
      land.cover(places);
      for (int k = 0; k < places.count; ++k)
        if (const auto tree = tree_at(places, k, hash(first + k, j, seed)))
          rows[static_cast<std::size_t>(j)].push_back(*tree);
    }
  });
  return rows;
}

LinearRgb roof_of(std::uint32_t id) {
  const float tone = 0.8F + 0.45F * unit(mix(id + 9));
  if (id % 7 == 0) return tone * linear_rgb(0.72F, 0.70F, 0.66F);
  if (id % 7 == 1) return tone * linear_rgb(0.42F, 0.41F, 0.40F);
  return tone * linear_rgb(0.44F, 0.235F, 0.145F);
}

}  // namespace

Ground::Ground(double texel_m,
               double pixel_rad,
               double extinction_per_km,
               const Sky& sky,
               const Clouds& clouds,
               std::uint32_t seed)
    : pixel_rad_(static_cast<float>(pixel_rad)),
      extinction_per_m_(static_cast<float>(extinction_per_km / 1000)),
      sun_(sky.sun_in_world()),
      sunlight_(sky.sunlight()) {
  const auto wanted = static_cast<unsigned>(std::clamp(kLand_m / texel_m, 512.0, 4096.0));
  const int size = static_cast<int>(std::bit_ceil(wanted * 3 / 4));
  texel_m_ = kLand_m / static_cast<float>(size);
  const float up = static_cast<float>(std::max(-sun_.z(), 0.1));
  sunlight_ *= 0.25F + 0.9F * up;
  skylight_ = linear_rgb(0.20F, 0.25F, 0.33F);
  shadow_ = clouds.ground_shadow(kShadowCells);
  make_haze(sky);
  detail_.resize(std::size_t{kDetailCells} * kDetailCells);
  for (int y = 0; y < kDetailCells; ++y)
    for (int x = 0; x < kDetailCells; ++x)
      detail_[static_cast<std::size_t>(y * kDetailCells + x)] = fractal(
          static_cast<float>(x) / 16, static_cast<float>(y) / 16, 4, kDetailCells / 16, seed + 41);
  map_ = MipMap::with_size(size);
  const Land land(seed);
  paint(land);
  plant(land, seed + 50);
  build(seed + 60);
  make_levels();
  find_peaks();
}

void Ground::make_haze(const Sky& sky) {
  const Vector3 level_sun = Vector3(sun_.x(), sun_.y(), 0).normalized();
  const double level = std::hypot(sun_.x(), sun_.y());
  const Vector3 side(-level_sun.y(), level_sun.x(), 0);
  for (int i = 0; i < kHazeSectors; ++i) {
    const double cosine =
        std::clamp((2.0 * i / (kHazeSectors - 1) - 1) / std::max(level, 1e-6), -1.0, 1.0);
    const LinearRgb haze = sky.haze(cosine * level_sun + std::sqrt(1 - cosine * cosine) * side);
    for (int c = 0; c < 3; ++c)
      haze_[static_cast<std::size_t>(c)][static_cast<std::size_t>(i)] = haze[c];
  }
}

std::uint32_t& Ground::texel(int x, int y) {
  const int wrap = map_.size - 1;
  return map_
      .texels[static_cast<std::size_t>(index_of_row(y & wrap, wrap) + index_in_row(x & wrap))];
}

void Ground::paint(const Land& land) {
  const int size = map_.size;
  tbb::parallel_for(0, size, [&](int y) {
    Places places;
    alignas(64) Integers packed;
    for (int first = 0; first < size; first += kBatch) {
      places.count = std::min(kBatch, size - first);
      for (int k = 0; k < places.count; ++k) {
        places.north_m[k] = (static_cast<float>(first + k) + 0.5F) * texel_m_;
        places.east_m[k] = (static_cast<float>(y) + 0.5F) * texel_m_;
      }
      land.cover(places);
      pack_ground(places, packed);
      for (int k = 0; k < places.count; ++k)
        texel(first + k, y) = static_cast<std::uint32_t>(packed[k]);
    }
  });
}

// Plants woods, riverside trees, trees along tracks, and single holm oaks in the fields.
void Ground::plant(const Land& land, std::uint32_t seed) {
  const auto rows = trees_on(land, seed);
  const float up = static_cast<float>(std::max(-sun_.z(), 0.3));
  for (const auto& row : rows)
    for (const Tree& t : row) {
      const float shift = -0.75F * t.height_m / up;
      darken(t.north_m + shift * static_cast<float>(sun_.x()),
             t.east_m + shift * static_cast<float>(sun_.y()),
             1.05F * t.radius_m,
             0.62F);
    }
  for (const auto& row : rows)
    for (const Tree& t : row) tree(t.north_m, t.east_m, t.radius_m, t.height_m, t.colour);
}

void Ground::darken(float north_m, float east_m, float radius_m, float factor) {
  const float x = north_m / texel_m_;
  const float y = east_m / texel_m_;
  const float r = radius_m / texel_m_;
  for (int j = floor_int(y - r); j <= floor_int(y + r); ++j)
    for (int i = floor_int(x - r); i <= floor_int(x + r); ++i) {
      const float dx = static_cast<float>(i) + 0.5F - x;
      const float dy = static_cast<float>(j) + 0.5F - y;
      if (dx * dx + dy * dy > r * r) continue;
      std::uint32_t& t = texel(i, j);
      const auto dim = [&](int shift) {
        return static_cast<std::uint32_t>(static_cast<float>((t >> shift) & 255) * factor) << shift;
      };
      t = dim(0) | dim(8) | dim(16) | (t & 0xFF000000U);
    }
}

void Ground::tree(
    float north_m, float east_m, float radius_m, float height_m, const LinearRgb& colour) {
  const float x = north_m / texel_m_;
  const float y = east_m / texel_m_;
  const float r = std::max(radius_m / texel_m_, 0.5F);
  for (int j = floor_int(y - r); j <= floor_int(y + r); ++j)
    for (int i = floor_int(x - r); i <= floor_int(x + r); ++i) {
      const float dx = (static_cast<float>(i) + 0.5F - x) / r;
      const float dy = (static_cast<float>(j) + 0.5F - y) / r;
      const float square = dx * dx + dy * dy;
      if (square > 1) continue;
      const float top = height_m * std::sqrt(1 - 0.8F * square);
      std::uint32_t& t = texel(i, j);
      if (top / kHighest_m * 255 < static_cast<float>(t >> 24)) continue;
      const float facing = dx * static_cast<float>(sun_.x()) + dy * static_cast<float>(sun_.y());
      t = pack(colour * (0.85F + 0.75F * facing), top);
    }
}

void Ground::house(float north_m,
                   float east_m,
                   float angle,
                   float length_m,
                   float width_m,
                   float height_m,
                   const LinearRgb& roof) {
  const float c = std::cos(angle);
  const float s = std::sin(angle);
  const float reach = length_m + width_m;
  const float facing = -s * static_cast<float>(sun_.x()) + c * static_cast<float>(sun_.y());
  for (int j = floor_int((east_m - reach) / texel_m_); j <= floor_int((east_m + reach) / texel_m_);
       ++j)
    for (int i = floor_int((north_m - reach) / texel_m_);
         i <= floor_int((north_m + reach) / texel_m_);
         ++i) {
      const float dx = (static_cast<float>(i) + 0.5F) * texel_m_ - north_m;
      const float dy = (static_cast<float>(j) + 0.5F) * texel_m_ - east_m;
      const float u = c * dx + s * dy;
      const float v = -s * dx + c * dy;
      if (std::abs(u) > length_m / 2 || std::abs(v) > width_m / 2) continue;
      const float ridge = 1 - 2 * std::abs(v) / width_m;
      const float slope = v > 0 ? facing : -facing;
      texel(i, j) = pack(roof * (0.85F + 0.45F * slope), height_m + 0.22F * width_m * ridge);
    }
}

// Builds villages of tiled roofs around a few streets, and single barns.
void Ground::build(std::uint32_t seed) {
  constexpr int kVillages = 6, kBarns = 40;
  for (int k = 0; k < kVillages; ++k) build_village(k, seed);
  for (int k = 0; k < kBarns; ++k) build_barn(hash(k, 2, seed));
}

void Ground::build_village(int k, std::uint32_t seed) {
  constexpr int kHouses = 90;
  const std::uint32_t village = hash(k, 1, seed);
  const float north = kLand_m * unit(village);
  const float east = kLand_m * unit(mix(village));
  const float street = 3.14F * unit(mix(village + 1));
  const int houses = kHouses / 3 + static_cast<int>(kHouses * unit(mix(village + 2)));
  for (int i = 0; i < houses; ++i) {
    const std::uint32_t id = hash(i, k, seed + 1);
    const float far_m = 30 + 150 * std::sqrt(unit(id)) * (0.4F + 0.6F * unit(mix(id + 1)));
    const float angle = 6.2832F * unit(mix(id + 2));
    // The houses stand along a grid of lanes 26 m apart.
    const float u = 26 * std::round(far_m * std::cos(angle) * 1.5F / 26) + 5 * unit(mix(id + 3));
    const float v = 17 * std::round(far_m * std::sin(angle) / 17);
    const float x = north + std::cos(street) * u - std::sin(street) * v;
    const float y = east + std::sin(street) * u + std::cos(street) * v;
    house(x,
          y,
          street + (id % 3 == 0 ? 1.571F : 0.0F),
          11 + 9 * unit(mix(id + 4)),
          8 + 4 * unit(mix(id + 5)),
          4.5F + 3 * unit(mix(id + 6)),
          roof_of(id));
  }
  house(north, east, street, 9, 9, 12, roof_of(3));
}

void Ground::build_barn(std::uint32_t id) {
  const float angle = 3.14F * unit(mix(id + 1));
  const float x = kLand_m * unit(mix(id + 2));
  const float y = kLand_m * unit(mix(id + 3));
  house(x, y, angle, 30 + 35 * unit(mix(id + 4)), 13, 5, roof_of(id % 3));
  house(x + 30, y + 12, angle + 1.571F, 18, 10, 4.5F, roof_of(id));
}

void Ground::find_peaks() {
  int cells = static_cast<int>(kLand_m / 10);
  const int size = map_.size;
  const int ratio = size / cells;
  const auto at = [](int x, int y, int n) {
    return static_cast<std::size_t>((y & (n - 1)) * n + (x & (n - 1)));
  };
  std::vector<std::uint8_t> highest(static_cast<std::size_t>(cells * cells), 0);
  tbb::parallel_for(0, cells, [&](int row) {
    for (int y = row * ratio; y < (row + 1) * ratio; ++y)
      for (int x = 0; x < size; ++x) {
        std::uint8_t& cell = highest[at(x / ratio, row, cells)];
        cell = std::max(cell, static_cast<std::uint8_t>(texel(x, y) >> 24));
      }
  });
  for (std::int32_t& first : first_peak_) {
    std::vector<std::uint8_t> around(highest.size(), 0);
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x)
        for (int k = 0; k < 9; ++k)
          around[at(x, y, cells)] =
              std::max(around[at(x, y, cells)], highest[at(x + k % 3 - 1, y + k / 3 - 1, cells)]);
    first = static_cast<std::int32_t>(peaks_.size());
    peaks_.insert(peaks_.end(), around.begin(), around.end());
    const int half = cells / 2;
    std::vector<std::uint8_t> coarse(static_cast<std::size_t>(half * half), 0);
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x)
        coarse[at(x / 2, y / 2, half)] =
            std::max(coarse[at(x / 2, y / 2, half)], highest[at(x, y, cells)]);
    highest = std::move(coarse);
    cells = half;
  }
}

namespace {

// Colours are stored as square roots of light and averaged as light. The height is averaged
// directly.
std::uint32_t mean_of(const std::array<std::uint32_t, 4>& texels) {
  std::uint32_t mean = 0;
  for (int shift = 0; shift < 24; shift += 8) {
    float light = 0;
    for (const std::uint32_t t : texels) {
      const auto root = static_cast<float>((t >> shift) & 255U);
      light += root * root;
    }
    mean |= static_cast<std::uint32_t>(std::sqrt(0.25F * light) + 0.5F) << shift;
  }
  std::uint32_t height = 2;
  for (const std::uint32_t t : texels) height += t >> 24;
  return mean | (height / 4) << 24;
}

}  // namespace

void Ground::make_levels() {
  for (std::size_t level = 1; level < static_cast<std::size_t>(map_.levels); ++level) {
    const std::uint32_t* fine = &map_.texels[static_cast<std::size_t>(map_.first[level - 1])];
    std::uint32_t* coarse = &map_.texels[static_cast<std::size_t>(map_.first[level])];
    const std::int32_t wrap = map_.wrap[level];
    tbb::parallel_for(0, wrap + 1, [&](std::int32_t y) {
      for (std::int32_t x = 0; x <= wrap; ++x) {
        const std::uint32_t* p = fine + index_of_row(2 * y, 2 * wrap + 1) + index_in_row(2 * x);
        coarse[index_of_row(y, wrap) + index_in_row(x)] = mean_of({p[0], p[1], p[4], p[5]});
      }
    });
  }
}

}  // namespace airtruth::synthetic
