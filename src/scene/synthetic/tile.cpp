// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/tile.h"

#include <bit>
#include <cmath>
#include <optional>

#include <tbb/parallel_for.h>

namespace airtruth::synthetic {
namespace {

// Where a constant of this file states no origin, it is a choice: the world is invented.

// Pitch of the grid of possible tree positions.
constexpr float kPlanting_m = 6.4F;

std::uint32_t pack(const LinearRgb& albedo, float height_m) {
  const auto byte = [](float x) { return static_cast<std::uint32_t>(clamp01(x) * 255 + 0.5F); };
  return byte(std::sqrt(albedo[0])) | byte(std::sqrt(albedo[1])) << 8 |
         byte(std::sqrt(albedo[2])) << 16 | byte(height_m / Tile::kHighest_m) << 24;
}

struct Tree {
  float north_m, east_m, radius_m, height_m;
  LinearRgb colour;
};

// The size of a house up to its eaves.
struct Size {
  float length_m, width_m, height_m;
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

// Draws over the land: shadows, trees and houses.
class Painter {
 public:
  Painter(Tile& tile, const Vector3& sun_in_world)
      : tile_(tile),
        sun_north_(static_cast<float>(sun_in_world.x())),
        sun_east_(static_cast<float>(sun_in_world.y())),
        sun_up_(static_cast<float>(std::max(-sun_in_world.z(), 0.3))) {}

  void paint(const Land& land) {
    const int size = tile_.size;
    tbb::parallel_for(0, size, [&](int y) {
      Places places;
      for (int first = 0; first < size; first += kBatch) {
        places.count = std::min(kBatch, size - first);
        for (int k = 0; k < places.count; ++k) {
          places.north_m[k] = (static_cast<float>(first + k) + 0.5F) * tile_.texel_m;
          places.east_m[k] = (static_cast<float>(y) + 0.5F) * tile_.texel_m;
        }
        land.cover(places);
        for (int k = 0; k < places.count; ++k)
          tile_.texel(first + k, y) =
              pack(linear_rgb(places.red[k], places.green[k], places.blue[k]), 0);
      }
    });
  }

  // Plants woods, riverside trees, trees along tracks, and single holm oaks in the fields. All
  // shadows come before the trees.
  void plant(const Land& land, std::uint32_t seed) {
    const auto rows = trees_on(land, seed);
    for (const auto& row : rows)
      for (const Tree& tree : row) darken(tree);
    for (const auto& row : rows)
      for (const Tree& tree : row) draw(tree);
  }

  // Builds villages of tiled roofs around a few streets, and single barns.
  void build(std::uint32_t seed) {
    // Numbers on the whole land.
    constexpr int kVillages = 6, kBarns = 40;
    for (int k = 0; k < kVillages; ++k) build_village(k, seed);
    for (int k = 0; k < kBarns; ++k) build_barn(hash(k, 2, seed));
  }

 private:
  // Calls draw(x, y, texel) for the texels around a place; x and y are its centre's, in texels.
  template <typename Draw>
  void around(float north_m, float east_m, float reach_m, const Draw& draw) {
    const float t = tile_.texel_m;
    for (int j = floor_int((east_m - reach_m) / t); j <= floor_int((east_m + reach_m) / t); ++j)
      for (int i = floor_int((north_m - reach_m) / t); i <= floor_int((north_m + reach_m) / t); ++i)
        draw(static_cast<float>(i) + 0.5F, static_cast<float>(j) + 0.5F, tile_.texel(i, j));
  }

  // Draws the shadow of a tree.
  void darken(const Tree& tree) {
    const float shift = -0.75F * tree.height_m / sun_up_;
    const float north_m = tree.north_m + shift * sun_north_;
    const float east_m = tree.east_m + shift * sun_east_;
    const float radius_m = 1.05F * tree.radius_m;
    const float r = radius_m / tile_.texel_m;
    around(north_m, east_m, radius_m, [&](float x, float y, std::uint32_t& t) {
      const float dx = x - north_m / tile_.texel_m;
      const float dy = y - east_m / tile_.texel_m;
      if (dx * dx + dy * dy > r * r) return;
      const auto dim = [&](int shift_bits) {
        return static_cast<std::uint32_t>(static_cast<float>((t >> shift_bits) & 255) * 0.62F)
               << shift_bits;
      };
      t = dim(0) | dim(8) | dim(16) | (t & 0xFF000000U);
    });
  }

  void draw(const Tree& tree) {
    const float r = std::max(tree.radius_m / tile_.texel_m, 0.5F);
    around(tree.north_m, tree.east_m, r * tile_.texel_m, [&](float x, float y, std::uint32_t& t) {
      const float dx = (x - tree.north_m / tile_.texel_m) / r;
      const float dy = (y - tree.east_m / tile_.texel_m) / r;
      const float square = dx * dx + dy * dy;
      if (square > 1) return;
      const float top = tree.height_m * std::sqrt(1 - 0.8F * square);
      if (top / Tile::kHighest_m * 255 < static_cast<float>(t >> 24)) return;
      t = pack(tree.colour * (0.85F + 0.75F * (dx * sun_north_ + dy * sun_east_)), top);
    });
  }

  void house(float north_m, float east_m, float angle, const Size& size, const LinearRgb& roof) {
    const float c = std::cos(angle);
    const float s = std::sin(angle);
    const float facing = -s * sun_north_ + c * sun_east_;
    around(north_m, east_m, size.length_m + size.width_m, [&](float x, float y, std::uint32_t& t) {
      const float dx = x * tile_.texel_m - north_m;
      const float dy = y * tile_.texel_m - east_m;
      const float u = c * dx + s * dy;
      const float v = -s * dx + c * dy;
      if (std::abs(u) > size.length_m / 2 || std::abs(v) > size.width_m / 2) return;
      const float ridge = 1 - 2 * std::abs(v) / size.width_m;
      const float slope = v > 0 ? facing : -facing;
      t = pack(roof * (0.85F + 0.45F * slope), size.height_m + 0.22F * size.width_m * ridge);
    });
  }

  void build_village(int k, std::uint32_t seed) {
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
      const Size size{
          11 + 9 * unit(mix(id + 4)), 8 + 4 * unit(mix(id + 5)), 4.5F + 3 * unit(mix(id + 6))};
      house(x, y, street + (id % 3 == 0 ? 1.571F : 0.0F), size, roof_of(id));
    }
    house(north, east, street, {9, 9, 12}, roof_of(3));
  }

  void build_barn(std::uint32_t id) {
    const float angle = 3.14F * unit(mix(id + 1));
    const float x = kLand_m * unit(mix(id + 2));
    const float y = kLand_m * unit(mix(id + 3));
    house(x, y, angle, {30 + 35 * unit(mix(id + 4)), 13, 5}, roof_of(id % 3));
    house(x + 30, y + 12, angle + 1.571F, {18, 10, 4.5F}, roof_of(id));
  }

  Tile& tile_;
  float sun_north_, sun_east_, sun_up_;
};

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

void Tile::make_levels() {
  for (std::size_t level = 1; level < static_cast<std::size_t>(levels); ++level) {
    const std::uint32_t* fine = &texels[static_cast<std::size_t>(first[level - 1])];
    std::uint32_t* coarse = &texels[static_cast<std::size_t>(first[level])];
    const std::int32_t last = wrap[level];
    tbb::parallel_for(0, last + 1, [&](std::int32_t y) {
      for (std::int32_t x = 0; x <= last; ++x) {
        const std::uint32_t* p = fine + index_of_row(2 * y, 2 * last + 1) + index_in_row(2 * x);
        coarse[index_of_row(y, last) + index_in_row(x)] = mean_of({p[0], p[1], p[4], p[5]});
      }
    });
  }
}

void Tile::find_peaks() {
  int cells = static_cast<int>(kLand_m / kPeakCell_m);
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
  for (std::int32_t& begin : first_peak) {
    std::vector<std::uint8_t> around(highest.size(), 0);
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x)
        for (int k = 0; k < 9; ++k)
          around[at(x, y, cells)] =
              std::max(around[at(x, y, cells)], highest[at(x + k % 3 - 1, y + k / 3 - 1, cells)]);
    begin = static_cast<std::int32_t>(peaks.size());
    peaks.insert(peaks.end(), around.begin(), around.end());
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

Tile::Tile(double wanted_m, const Vector3& sun_in_world, std::uint32_t seed) {
  const auto wanted = static_cast<unsigned>(std::clamp(kLand_m / wanted_m, 512.0, 4096.0));
  size = static_cast<int>(std::bit_ceil(wanted * 3 / 4));
  texel_m = kLand_m / static_cast<float>(size);
  std::int32_t total = 0;
  for (int side = size; side >= 2; side /= 2) {
    const auto level = static_cast<std::size_t>(levels++);
    first[level] = total;
    wrap[level] = side - 1;
    scale[level] = static_cast<float>(side) / static_cast<float>(size);
    total += std::max(side * side, 16);
  }
  texels.resize(static_cast<std::size_t>(total));
  const Land land(seed);
  Painter painter(*this, sun_in_world);
  painter.paint(land);
  painter.plant(land, seed + 50);
  painter.build(seed + 60);
  make_levels();
  find_peaks();
}

}  // namespace airtruth::synthetic
