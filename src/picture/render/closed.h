// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "aircraft/model/mesh.h"
#include "foundation/geometry/transform.h"
#include "picture/render/model.h"

// The closed surfaces of an aircraft. A ray from outside enters a closed surface as often as it
// leaves it. So where it meets the surface at all, it meets a triangle that faces the eye, and the
// triangles that face away add nothing to the outline, nor to what is visible (back-face culling:
// Foley et al. 1990, "Computer graphics: principles and practice", 15.4).
//
// A surface is the triangles that are connected by sides of which each belongs to two of them. It
// is closed where its triangles can be given directions of rotation such that every side is passed
// as often one way as the other.
namespace airtruth::render {

// By [part][triangle]: 1 where the triangle's own normal points out of a closed surface, -1 where
// it points into it. 0 where the surface is open, encloses nothing, or has a triangle that is not
// opaque. opaque: as Model::Impl::opaque.
std::vector<std::vector<std::int8_t>> outward_normals(
    const aircraft::Mesh& mesh, const std::vector<std::vector<std::uint8_t>>& opaque);

// Sets those to 0 whose inner side sees the open, by the model's openness: where a surface passes
// through itself, what should be its inside may lie outside. A triangle that is tested in vain
// changes nothing.
void leave_open_insides(const Model::Impl& model, std::vector<std::vector<std::int8_t>>& outward);

// Which triangles of a part face away from the eye.
class FacingAway {
 public:
  // outward: of outward_normals(). eye_in_part: at one moment or at three; the eye must be outside
  // all closed surfaces.
  FacingAway(const aircraft::Mesh& mesh,
             const aircraft::Part& part,
             const std::vector<std::int8_t>& outward,
             std::vector<Vector3> eye_in_part);

  // True where a triangle of a closed surface faces away from the eye at all moments and on the
  // parabola between them.
  bool operator()(std::size_t triangle) const;

 private:
  const aircraft::Mesh& mesh_;
  const aircraft::Part& part_;
  const std::vector<std::int8_t>& outward_;
  std::vector<Vector3> eye_in_part_;
};

}  // namespace airtruth::render
