// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "aircraft/model/mesh.h"

// The surfaces of a mesh: triangles that are connected by sides of which each belongs to two of
// them. Vertices at equal positions are one point, since meshes with hard edges have several there.
namespace airtruth::render {

// A side of a triangle.
struct Side {
  // Of its two points, the smaller first.
  std::uint64_t points;
  std::uint32_t triangle;
  // 1 where the triangle passes it from the smaller point to the larger, else -1.
  std::int8_t direction;
};

constexpr std::uint32_t kNoSurface = std::numeric_limits<std::uint32_t>::max();

// The surfaces of a part.
struct Surfaces {
  // The sides of all triangles with three different corners; equal ones follow one another.
  std::vector<Side> sides;
  // By triangle: its surface, or kNoSurface where corners coincide; and whether its direction of
  // rotation is kept (1) or turned (-1), so that neighbours pass their common side in opposite
  // directions. On a surface with one side only (Moebius 1858) some neighbours do not.
  std::vector<std::uint32_t> of;
  std::vector<std::int8_t> sign;
  std::uint32_t count = 0;
};

// By part.
std::vector<Surfaces> surfaces_of(const aircraft::Mesh& mesh);

// Calls use(first, last) for the sides between the same two points.
template <typename Use>
void for_each_side(const std::vector<Side>& sides, const Use& use) {
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last = std::find_if(
        first, sides.end(), [&](const Side& side) { return side.points != first->points; });
    use(first, last);
    first = last;
  }
}

}  // namespace airtruth::render
