// SPDX-License-Identifier: Apache-2.0
#include "picture/render/pencil.h"

#include "picture/render/pixel_rays.h"

namespace airtruth::render {

Silhouette::Pencil Silhouette::pencil_of(int x, int y) const {
  Pencil pencil;
  pencil.moves = actor_.moves;
  if (!actor_.moves) {
    pencil.direction[1] = grid_.corners(x, y);
    pencil.known = finite(pencil.direction[1]);
    return pencil;
  }
  const Beam beam = beam_of(actor_, grid_, x, y);
  pencil.known = beam.known;
  pencil.exposes = beam.exposes;
  pencil.direction = beam.direction_in_body;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t c = 0; c < 4; ++c)
      pencil.moment[k][c] = beam.eye_in_body[k].cross(pencil.direction[k][c]);
  return pencil;
}

bool Silhouette::is_known(int x, int y) const {
  for (int k = actor_.moves ? 0 : 1; k < (actor_.moves ? 3 : 2); ++k)
    if (!finite(grid_.corners(x, y, k))) return false;
  return true;
}

}  // namespace airtruth::render
