// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/ground.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include <tbb/parallel_for.h>

namespace airtruth::synthetic {
namespace {

// Where a constant of this file states no origin, it is a choice: the world is invented.

// Beyond this distance the ground is flat.
constexpr float kReliefEnd_m = 5000;
// Distance at which the hills begin.
constexpr float kFarthest_m = 26000;
// Side of the smallest cells of Ground::peaks_.
constexpr float kPeakCell_m = 10;
// Side of a cell of Ground::detail_.
constexpr float kDetail_m = 0.4F;
// Distance up to which the ground has detail that is finer than its texels.
constexpr float kDetailEnd_m = 1200;
// The optical depth at which nothing of the light is left in single precision.
constexpr float kOpaque = 80;

// Bilinear interpolation in a square table that repeats.
[[gnu::always_inline]] inline float interpolated(const float* table, int cells, float x, float y) {
  const int ix = floor_int(x);
  const int iy = floor_int(y);
  const float fx = x - static_cast<float>(ix);
  const float fy = y - static_cast<float>(iy);
  const int wrap = cells - 1;
  const int upper = (iy & wrap) * cells;
  const int lower = ((iy + 1) & wrap) * cells;
  const int left = ix & wrap;
  const int right = (ix + 1) & wrap;
  return lerp(lerp(table[upper + left], table[upper + right], fx),
              lerp(table[lower + left], table[lower + right], fx),
              fy);
}

// Square roots of red, green and blue of one mip level, 0 to 65280.
struct Roots {
  float red, green, blue;
};

[[gnu::always_inline]] inline Roots roots(
    const std::uint32_t* texels, float x, float y, std::int32_t first, std::int32_t wrap) {
  const Neighbours n = neighbours(x, y, first, wrap);
  const std::uint32_t red_blue =
      weighted(texels, n, [](std::uint32_t texel) { return texel & 0x00FF00FFU; });
  const std::uint32_t green =
      weighted(texels, n, [](std::uint32_t texel) { return (texel >> 8) & 0xFFU; });
  const auto real = [](std::uint32_t sum) {
    return static_cast<float>(static_cast<std::int32_t>(sum));
  };
  return {real(red_blue & 0xFFFFU), real(green), real(red_blue >> 16)};
}

// Light of the ground through the air, of one colour.
struct Colour {
  const float* haze;
  float sunlight;
  float skylight;
  [[gnu::always_inline]] float seen(float root, float grain, float lit, float shade) const {
    return root * root * grain * (sunlight * lit + skylight) * shade;
  }
  [[gnu::always_inline]] float veiled(float light, int sector, float part, float fog) const {
    const float veil = haze[sector] + (haze[sector + 1] - haze[sector]) * part;
    return light + (veil - light) * fog;
  }
};

// Copies the rays that the search names.
AIRTRUTH_FOR_VECTORS
void select_rays(const Rays& rays,
                 const Floats& far_m,
                 const Floats& across,
                 const Floats& peak_m,
                 Search& __restrict search) {
  const int count = search.count;
  select(rays.north, search.ray, count, search.north);
  select(rays.east, search.ray, count, search.east);
  select(rays.down, search.ray, count, search.down);
  select(far_m, search.ray, count, search.far_m);
  select(across, search.ray, count, search.across);
  select(peak_m, search.ray, count, search.peak_m);
}

}  // namespace

// The distance to the level ground, and the cell of greatest heights around the ray's last part.
AIRTRUTH_FOR_VECTORS
void Ground::reach(const Eye& eye, const Rays& rays, Points& __restrict points) const {
  const int count = rays.count;
  const std::int32_t* first = first_peak_.data();
  const float per_texel = 1 / texel_m_;
  const float pixel_rad = pixel_rad_;
  for (int i = 0; i < count; ++i) {
    const float far_m = eye.height_m / std::max(rays.down[i], 1e-5F);
    const float reach_m = std::min(far_m, kFarthest_m);
    points.far_m[i] = far_m;
    points.reach_m[i] = reach_m;
    points.distance_m[i] = reach_m;
    points.shade[i] = 1;
    points.across[i] = fast_log2(std::max(reach_m * pixel_rad * per_texel, 0.01F));
    const float span_m = kHighest_m / rays.down[i];
    const float middle_m = far_m - 0.5F * span_m;
    std::int32_t level = 0;
    float cell_m = kPeakCell_m;
    for (int k = 1; k < kPeakLevels; ++k) {
      const bool wider = 2 * cell_m < span_m;
      cell_m = wider ? 2 * cell_m : cell_m;
      level += wider ? 1 : 0;
    }
    const int cells = static_cast<int>(kLand_m / cell_m);
    const int x = floor_int((eye.north_m + middle_m * rays.north[i]) / cell_m) & (cells - 1);
    const int y = floor_int((eye.east_m + middle_m * rays.east[i]) / cell_m) & (cells - 1);
    points.level[i] = level;
    points.cell[i] = y * cells + x;
  }
  for (int i = 0; i < count; ++i) points.cell[i] += first[points.level[i]];
}

void Ground::meet(const Eye& eye, const Rays& rays, Points& points) const {
  Search search;
  alignas(64) Floats peak_m;
  for (int i = 0; i < rays.count; ++i) {
    const std::uint8_t peak = peaks_[static_cast<std::size_t>(points.cell[i])];
    peak_m[i] = static_cast<float>(peak) * (kHighest_m / 255);
    search.ray[search.count] = i;
    search.count += ((peak != 0) & (points.far_m[i] < kReliefEnd_m)) ? 1 : 0;
  }
  if (search.count == 0) return;
  select_rays(rays, points.far_m, points.across, peak_m, search);
  synthetic::meet({&map_, texel_m_, kHighest_m}, eye, search);
  for (int k = 0; k < search.count; ++k) {
    if (search.distance_m[k] < 0) continue;
    points.distance_m[search.ray[k]] = search.distance_m[k];
    points.shade[search.ray[k]] = search.shade[k];
  }
}

// Where the tables are read: the mip level and the sector of the haze.
AIRTRUTH_FOR_VECTORS
void Ground::look_up(const Eye& eye, const Rays& rays, Points& __restrict points) const {
  const int count = rays.count;
  const int top = map_.levels - 2;
  const float extinction_per_m = extinction_per_m_;
  const auto sun_north = static_cast<float>(sun_.x());
  const auto sun_east = static_cast<float>(sun_.y());
  for (int i = 0; i < count; ++i) {
    const float along = std::min(-fast_log2(std::max(rays.down[i], 1e-4F)), 5.0F);
    const float level =
        std::clamp(points.across[i] + 0.5F * along - 0.6F, 0.0F, static_cast<float>(top));
    points.level[i] = std::min(static_cast<int>(level), top - 1);
    points.level_part[i] = level - static_cast<float>(points.level[i]);
    const float cosine =
        std::clamp(rays.north[i] * sun_north + rays.east[i] * sun_east, -1.0F, 1.0F);
    const float at = (cosine * 0.5F + 0.5F) * (kHazeSectors - 1.001F);
    points.sector[i] = static_cast<int>(at);
    points.sector_part[i] = at - static_cast<float>(points.sector[i]);
    points.fog[i] = 1 - exp_of_negative(std::max(-points.reach_m[i] * extinction_per_m, -kOpaque));
    points.north_m[i] = eye.north_m + points.distance_m[i] * rays.north[i];
    points.east_m[i] = eye.east_m + points.distance_m[i] * rays.east[i];
  }
}

// The square roots of the ground's colour.
AIRTRUTH_FOR_VECTORS
void Ground::colour(const Points& points, int count, Light& __restrict light) const {
  const std::uint32_t* texels = map_.texels.data();
  const std::int32_t* first = map_.first.data();
  const std::int32_t* wrap = map_.wrap.data();
  const float* scale = map_.scale.data();
  const float per_texel = 1 / texel_m_;
  for (int i = 0; i < count; ++i) {
    const std::int32_t level = points.level[i];
    const float x = points.north_m[i] * per_texel;
    const float y = points.east_m[i] * per_texel;
    const Roots fine =
        roots(texels, x * scale[level] - 0.5F, y * scale[level] - 0.5F, first[level], wrap[level]);
    const Roots coarse = roots(texels,
                               x * scale[level + 1] - 0.5F,
                               y * scale[level + 1] - 0.5F,
                               first[level + 1],
                               wrap[level + 1]);
    // The weights of four texels sum to 256, and the largest root of a colour is 255.
    constexpr float kUnit = 1.0F / (256 * 255);
    light.red[i] = lerp(fine.red, coarse.red, points.level_part[i]) * kUnit;
    light.green[i] = lerp(fine.green, coarse.green, points.level_part[i]) * kUnit;
    light.blue[i] = lerp(fine.blue, coarse.blue, points.level_part[i]) * kUnit;
  }
}

AIRTRUTH_FOR_VECTORS
void Ground::shine(const Points& points, int count, Light& __restrict light) const {
  const float* shadow = shadow_.data();
  const float* detail = detail_.data();
  const float per_shadow = kShadowCells / static_cast<float>(Clouds::period_m());
  const Colour red{haze_[0].data(), sunlight_[0], skylight_[0]};
  const Colour green{haze_[1].data(), sunlight_[1], skylight_[1]};
  const Colour blue{haze_[2].data(), sunlight_[2], skylight_[2]};
  for (int i = 0; i < count; ++i) {
    const float north_m = points.north_m[i];
    const float east_m = points.east_m[i];
    const float mottle =
        interpolated(detail, kDetailCells, north_m / kDetail_m, east_m / kDetail_m);
    const float near = std::max(1 - points.distance_m[i] / kDetailEnd_m, 0.0F);
    const float grain = 1 + near * (mottle - 0.5F) * 0.7F;
    const float lit = interpolated(shadow, kShadowCells, north_m * per_shadow, east_m * per_shadow);
    const float shade = points.shade[i];
    const float fog = points.fog[i];
    const std::int32_t sector = points.sector[i];
    const float part = points.sector_part[i];
    light.red[i] = red.veiled(red.seen(light.red[i], grain, lit, shade), sector, part, fog);
    light.green[i] = green.veiled(green.seen(light.green[i], grain, lit, shade), sector, part, fog);
    light.blue[i] = blue.veiled(blue.seen(light.blue[i], grain, lit, shade), sector, part, fog);
  }
}

void Ground::seen(const Eye& eye, const Rays& rays, Light& light) const {
  Points points;
  reach(eye, rays, points);
  if (eye.height_m > kHighest_m) meet(eye, rays, points);
  look_up(eye, rays, points);
  colour(points, rays.count, light);
  shine(points, rays.count, light);
}

// Paints the tile: first the land, then shadows, trees and houses over it.
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
  // Numbers on the whole land.
  constexpr int kVillages = 6, kBarns = 40;
  for (int k = 0; k < kVillages; ++k) build_village(k, seed);
  for (int k = 0; k < kBarns; ++k) build_barn(hash(k, 2, seed));
}

void Ground::build_village(int k, std::uint32_t seed) {
  // A village has a third of this number of houses to four thirds of it.
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
