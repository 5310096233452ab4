// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/ground_tile.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include <tbb/parallel_for.h>

namespace airtruth::synthetic {
namespace {

// Pitch of the grid of possible tree positions.
constexpr float kPlanting_m = 6.4F;

std::uint32_t pack(const LinearRgb& albedo, float height_m) {
  const auto byte = [](float x) { return static_cast<std::uint32_t>(clamp01(x) * 255 + 0.5F); };
  return byte(std::sqrt(albedo[0])) | byte(std::sqrt(albedo[1])) << 8 |
         byte(std::sqrt(albedo[2])) << 16 | byte(height_m / GroundTile::kHighest_m) << 24;
}

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

struct Tree {
  float north_m, east_m, radius_m, height_m;
  LinearRgb colour;
};

// The tree of a planting cell, if one grows there: in woods, along the river and tracks, and single
// holm oaks in the fields.
std::optional<Tree> tree_in(int i, int j, const Land& land, std::uint32_t seed) {
  const std::uint32_t id = hash(i, j, seed);
  const float north_m = (static_cast<float>(i) + unit(id)) * kPlanting_m;
  const float east_m = (static_cast<float>(j) + unit(mix(id))) * kPlanting_m;
  const Cover cover = land.at(north_m, east_m);
  if (cover.track_m < 4.5F || cover.river_m < 11) return std::nullopt;
  float chance = 0.86F * cover.wood + (cover.field ? 0.0035F : 0.012F);
  if (cover.river_m < 40)
    chance = std::max(chance, 0.75F * smoothstep(40.0F, 22.0F, cover.river_m));
  if (cover.hedge && cover.track_m < 11) chance = std::max(chance, 0.62F);
  if (unit(mix(id + 1)) >= chance) return std::nullopt;
  const float size = unit(mix(id + 2));
  const LinearRgb green =
      lerp(0.75F, 1.35F, unit(mix(id + 3))) * linear_rgb(0.062F, 0.082F, 0.030F);
  return Tree{north_m, east_m, 2.0F + 2.6F * size, 4.0F + 6.5F * size, green};
}

LinearRgb roof_of(std::uint32_t id) {
  const float tone = 0.8F + 0.45F * unit(mix(id + 9));
  if (id % 7 == 0) return tone * linear_rgb(0.72F, 0.70F, 0.66F);
  if (id % 7 == 1) return tone * linear_rgb(0.42F, 0.41F, 0.40F);
  return tone * linear_rgb(0.44F, 0.235F, 0.145F);
}

}  // namespace

GroundTile::GroundTile(double texel_m, const Vector3& sun_in_world, std::uint32_t seed)
    : sun_(sun_in_world) {
  const auto wanted = static_cast<unsigned>(std::clamp(kLand_m / texel_m, 512.0, 4096.0));
  const int size = static_cast<int>(std::bit_ceil(wanted * 3 / 4));
  texel_m_ = kLand_m / static_cast<float>(size);
  for (int side = size; side >= 2; side /= 2) levels_.emplace_back(side);
  const Land land(seed);
  paint(land);
  plant(land, seed + 50);
  constexpr int kVillages = 6, kBarns = 40;
  for (int k = 0; k < kVillages; ++k) build_village(hash(k, 1, seed + 60), k, seed + 61);
  for (int k = 0; k < kBarns; ++k) build_barn(hash(k, 2, seed + 60));
  make_levels();
  find_peaks();
}

LinearRgb GroundTile::at(int level, float north_m, float east_m) const {
  const Tile<std::uint32_t>& tile = levels_[static_cast<std::size_t>(level)];
  const float per_m = static_cast<float>(tile.size()) * (1 / kLand_m);
  const float x = north_m * per_m - 0.5F;
  const float y = east_m * per_m - 0.5F;
  const int ix = floor_int(x);
  const int iy = floor_int(y);
  const auto right = static_cast<std::uint32_t>((x - static_cast<float>(ix)) * 16);
  const auto lower = static_cast<std::uint32_t>((y - static_cast<float>(iy)) * 16);
  // Sums of two bytes at once, with weights of 256 in all.
  std::uint32_t even = 0;
  std::uint32_t odd = 0;
  const auto add = [&](std::uint32_t texel, std::uint32_t weight) {
    even += (texel & 0x00FF00FFU) * weight;
    odd += ((texel >> 8) & 0x00FF00FFU) * weight;
  };
  add(tile.at(ix, iy), (16 - right) * (16 - lower));
  add(tile.at(ix + 1, iy), right * (16 - lower));
  add(tile.at(ix, iy + 1), (16 - right) * lower);
  add(tile.at(ix + 1, iy + 1), right * lower);
  const Eigen::Array4i sums(static_cast<int>(even & 0xFFFF),
                            static_cast<int>(odd & 0xFFFF),
                            static_cast<int>(even >> 16),
                            static_cast<int>(odd >> 16));
  return sums.cast<float>() * (1.0F / (256 * 255));
}

float GroundTile::height_m(int level, float north_m, float east_m) const {
  const Tile<std::uint32_t>& tile = levels_[static_cast<std::size_t>(level)];
  const float per_m = static_cast<float>(tile.size()) * (1 / kLand_m);
  const std::uint32_t texel = tile.at(floor_int(north_m * per_m), floor_int(east_m * per_m));
  return static_cast<float>(static_cast<int>(texel >> 24)) * (kHighest_m / 255);
}

float GroundTile::peak_m(float north_m, float east_m) const {
  return static_cast<float>(
             peaks_.at(floor_int(north_m / kPeakReach_m), floor_int(east_m / kPeakReach_m))) *
         (kHighest_m / 255);
}

void GroundTile::paint(const Land& land) {
  Tile<std::uint32_t>& tile = levels_.front();
  tbb::parallel_for(0, tile.size(), [&](int y) {
    const float east_m = (static_cast<float>(y) + 0.5F) * texel_m_;
    for (int x = 0; x < tile.size(); ++x)
      tile.at(x, y) = pack(land.at((static_cast<float>(x) + 0.5F) * texel_m_, east_m).albedo, 0);
  });
}

// Plants trees, with their shadows below them.
void GroundTile::plant(const Land& land, std::uint32_t seed) {
  constexpr int kCells = static_cast<int>(kLand_m / kPlanting_m);
  std::vector<std::vector<Tree>> rows(kCells);
  tbb::parallel_for(0, kCells, [&](int j) {
    for (int i = 0; i < kCells; ++i)
      if (const auto tree = tree_in(i, j, land, seed))
        rows[static_cast<std::size_t>(j)].push_back(*tree);
  });
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

template <typename Change>
void GroundTile::around(float north_m, float east_m, float reach_m, const Change& change) {
  const float x = north_m / texel_m_;
  const float y = east_m / texel_m_;
  const float r = reach_m / texel_m_;
  for (int j = floor_int(y - r); j <= floor_int(y + r); ++j)
    for (int i = floor_int(x - r); i <= floor_int(x + r); ++i)
      change(levels_.front().at(i, j),
             static_cast<float>(i) + 0.5F - x,
             static_cast<float>(j) + 0.5F - y);
}

void GroundTile::darken(float north_m, float east_m, float radius_m, float factor) {
  const float r = radius_m / texel_m_;
  around(north_m, east_m, radius_m, [&](std::uint32_t& t, float dx, float dy) {
    if (dx * dx + dy * dy > r * r) return;
    const auto dim = [&](int shift) {
      return static_cast<std::uint32_t>(static_cast<float>((t >> shift) & 255) * factor) << shift;
    };
    t = dim(0) | dim(8) | dim(16) | (t & 0xFF000000U);
  });
}

void GroundTile::tree(
    float north_m, float east_m, float radius_m, float height_m, const LinearRgb& colour) {
  const float r = std::max(radius_m / texel_m_, 0.5F);
  around(north_m, east_m, r * texel_m_, [&](std::uint32_t& t, float dx, float dy) {
    const float square = (dx * dx + dy * dy) / (r * r);
    if (square > 1) return;
    const float top = height_m * std::sqrt(1 - 0.8F * square);
    if (top / kHighest_m * 255 < static_cast<float>(t >> 24)) return;
    const float facing =
        dx / r * static_cast<float>(sun_.x()) + dy / r * static_cast<float>(sun_.y());
    t = pack(colour * (0.85F + 0.75F * facing), top);
  });
}

// A house with a tiled gable roof.
void GroundTile::house(const House& h) {
  const float c = std::cos(h.angle_rad);
  const float s = std::sin(h.angle_rad);
  const float facing = -s * static_cast<float>(sun_.x()) + c * static_cast<float>(sun_.y());
  around(h.north_m, h.east_m, h.length_m + h.width_m, [&](std::uint32_t& t, float dx, float dy) {
    const float u = (c * dx + s * dy) * texel_m_;
    const float v = (-s * dx + c * dy) * texel_m_;
    if (std::abs(u) > h.length_m / 2 || std::abs(v) > h.width_m / 2) return;
    const float ridge = 1 - 2 * std::abs(v) / h.width_m;
    const float slope = v > 0 ? facing : -facing;
    t = pack(h.roof * (0.85F + 0.45F * slope), h.height_m + 0.22F * h.width_m * ridge);
  });
}

// Houses along a grid of lanes 26 m apart, and a church.
void GroundTile::build_village(std::uint32_t id, int village, std::uint32_t seed) {
  constexpr int kHouses = 90;
  const float north_m = kLand_m * unit(id);
  const float east_m = kLand_m * unit(mix(id));
  const float street_rad = 3.14F * unit(mix(id + 1));
  const int houses = kHouses / 3 + static_cast<int>(kHouses * unit(mix(id + 2)));
  for (int i = 0; i < houses; ++i) {
    const std::uint32_t one = hash(i, village, seed);
    const float far_m = 30 + 150 * std::sqrt(unit(one)) * (0.4F + 0.6F * unit(mix(one + 1)));
    const float angle = 6.2832F * unit(mix(one + 2));
    const float u = 26 * std::round(far_m * std::cos(angle) * 1.5F / 26) + 5 * unit(mix(one + 3));
    const float v = 17 * std::round(far_m * std::sin(angle) / 17);
    house({north_m + std::cos(street_rad) * u - std::sin(street_rad) * v,
           east_m + std::sin(street_rad) * u + std::cos(street_rad) * v,
           street_rad + (one % 3 == 0 ? 1.571F : 0.0F),
           11 + 9 * unit(mix(one + 4)),
           8 + 4 * unit(mix(one + 5)),
           4.5F + 3 * unit(mix(one + 6)),
           roof_of(one)});
  }
  house({north_m, east_m, street_rad, 9, 9, 12, roof_of(3)});
}

// A single barn with a wing.
void GroundTile::build_barn(std::uint32_t id) {
  const float angle = 3.14F * unit(mix(id + 1));
  const float north_m = kLand_m * unit(mix(id + 2));
  const float east_m = kLand_m * unit(mix(id + 3));
  house({north_m, east_m, angle, 30 + 35 * unit(mix(id + 4)), 13, 5, roof_of(id % 3)});
  house({north_m + 30, east_m + 12, angle + 1.571F, 18, 10, 4.5F, roof_of(id)});
}

void GroundTile::make_levels() {
  for (std::size_t level = 1; level < levels_.size(); ++level) {
    const Tile<std::uint32_t>& fine = levels_[level - 1];
    Tile<std::uint32_t>& coarse = levels_[level];
    tbb::parallel_for(0, coarse.size(), [&](int y) {
      for (int x = 0; x < coarse.size(); ++x)
        coarse.at(x, y) = mean_of({fine.at(2 * x, 2 * y),
                                   fine.at(2 * x + 1, 2 * y),
                                   fine.at(2 * x, 2 * y + 1),
                                   fine.at(2 * x + 1, 2 * y + 1)});
    });
  }
}

void GroundTile::find_peaks() {
  peaks_ = Tile<std::uint8_t>(static_cast<int>(kLand_m / kPeakReach_m));
  const Tile<std::uint32_t>& tile = levels_.front();
  const int ratio = tile.size() / peaks_.size();
  tbb::parallel_for(0, peaks_.size(), [&](int row) {
    for (int column = 0; column < peaks_.size(); ++column)
      for (int y = (row - 1) * ratio; y < (row + 2) * ratio; ++y)
        for (int x = (column - 1) * ratio; x < (column + 2) * ratio; ++x)
          peaks_.at(column, row) =
              std::max(peaks_.at(column, row), static_cast<std::uint8_t>(tile.at(x, y) >> 24));
  });
}

}  // namespace airtruth::synthetic
