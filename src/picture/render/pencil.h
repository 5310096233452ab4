// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "picture/render/silhouette.h"

namespace airtruth::render {

// The rays of a pixel, as the planes of a triangle use them.
struct Silhouette::Pencil {
  bool known = true;
  bool moves = false;
  // Directions at a pixel's corners. At an instant: in world (moment 1). During a motion: in body,
  // with e x d, at the three moments of the pixel's exposure (or at moment 1 alone).
  Thrice<std::array<Vector3, 4>> direction;
  Thrice<std::array<Vector3, 4>> moment;
  bool exposes = false;

  double product(const Planes& planes, std::size_t side, std::size_t k, std::size_t corner) const {
    const double still = planes.side[side].dot(direction[k][corner]);
    return moves ? still + planes.edge[side].dot(moment[k][corner]) : still;
  }
};

}  // namespace airtruth::render
