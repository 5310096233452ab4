// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "aircraft/model/mesh.h"
#include "picture/shade/model_impl.h"

// The surfaces of a mesh: triangles that are connected by sides of which each belongs to two of
// them. Vertices at equal positions are one point, since meshes with hard edges have several there.
//
// The closed surfaces of an aircraft: those whose triangles can be given directions of rotation
// such that every side is passed as often one way as the other.
//
// The sides of an aircraft's triangles that an eye outside it can see. A triangle that turns
// another side to the eye adds nothing to the outline, nor to what is visible: other triangles hide
// all of it.
//
// - A ray from outside enters a closed surface as often as it leaves it. So where it meets the
//   surface at all, it meets a triangle that faces the eye (back-face culling: Foley et al. 1990,
//   "Computer graphics: principles and practice", 15.4). The inner sides are visible only where a
//   surface passes through itself, so that its inner side lies outside: there the inner side of a
//   triangle has an open direction, by the model's ambient occlusion.
// - Of an open surface, or one that lies within others, a side that sees the open at none of its
//   triangles is hidden: the ambient occlusion has 24 to 192 rays for each side of a triangle. One
//   ray that leaves the aircraft keeps that side of the whole surface, since the place where it
//   leaves may show triangles whose own rays miss it.
namespace airtruth::shade {

// A side of a triangle.
struct Side {
  // Of its two points, the smaller first.
  std::uint64_t points;
  std::uint32_t triangle;
  // 1 where the triangle passes it from the smaller point to the larger, else -1.
  std::int8_t direction;
};

// In place of the index of a surface.
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
std::vector<Surfaces> surfaces_of(const model::Mesh& mesh);

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

// By [part][triangle]: 1 where the triangle's own normal points out of a closed surface, -1 where
// it points into it. 0 where the surface is open, encloses nothing, or has a triangle that is not
// opaque. surfaces: of surfaces_of(). opaque: as Model::Impl::opaque.
std::vector<std::vector<std::int8_t>> outward_normals(
    const model::Mesh& mesh,
    const std::vector<Surfaces>& surfaces,
    const std::vector<std::vector<std::uint8_t>>& opaque);

enum OuterSides : std::uint8_t {
  kNoSide = 0,
  // To which the triangle's own normal points.
  kFrontSide = 1,
  kBackSide = 2,
  kBothSides = 3,
};

// By [part][triangle]. Of an open surface both sides where the model has a triangle that is not
// opaque: the rays of the ambient occlusion end there. The model's opaque triangles and ambient
// occlusion must be known.
std::vector<std::vector<OuterSides>> outer_sides(const Model::Impl& model);

// True where an eye outside the aircraft cannot see a triangle: it has no outer side, or its only
// one faces away at all moments and on the parabola between them. front_to_eye: the product of the
// front's normal and the vector from the triangle to the eye, at one moment or at three. `scale`:
// of the lengths of both.
bool is_hidden(OuterSides outer, std::span<const double> front_to_eye, double scale);

}  // namespace airtruth::shade
