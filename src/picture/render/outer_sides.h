// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "aircraft/model/mesh.h"
#include "picture/render/model.h"

// The sides of an aircraft's triangles that an eye outside it can see. A triangle that turns
// another side to the eye adds nothing to the outline, nor to what is visible: other triangles hide
// all of it.
//
// - A ray from outside enters a closed surface as often as it leaves it. So where it meets the
//   surface at all, it meets a triangle that faces the eye (back-face culling: Foley et al. 1990,
//   "Computer graphics: principles and practice", 15.4). The inner sides are seen only where a
//   surface passes through itself, so that its inner side lies outside: there the inner side of a
//   triangle sees the open, by the model's openness.
// - Of an open surface, or one that lies within others, a side that sees the open at none of its
//   triangles is hidden: the openness has 24 to 192 rays for each side of a triangle. One ray that
//   leaves the aircraft keeps that side of the whole surface, since the place where it leaves may
//   show triangles whose own rays miss it.
namespace airtruth::render {

enum OuterSides : std::uint8_t {
  kNoSide = 0,
  // To which the triangle's own normal points.
  kFrontSide = 1,
  kBackSide = 2,
  kBothSides = 3,
};

// By [part][triangle]. Of an open surface both sides where the model has a triangle that is not
// opaque: the rays of the openness end there. The model's opaque triangles and openness must be
// known.
std::vector<std::vector<OuterSides>> outer_sides(const Model::Impl& model);

// True where an eye outside the aircraft cannot see a triangle: it has no outer side, or its only
// one faces away at all moments and on the parabola between them. front_to_eye: the product of the
// front's normal and the vector from the triangle to the eye, at one moment or at three. `scale`:
// of the lengths of both.
bool is_hidden(OuterSides outer, std::span<const double> front_to_eye, double scale);

}  // namespace airtruth::render
