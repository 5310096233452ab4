// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "aircraft/model/mesh.h"

namespace airtruth::shade {

enum class Opacity {
  // The triangle hides all behind it: its material is opaque, and so is every texel whose middle
  // lies within it, or where none does, the texel in its middle. A livery's texture has transparent
  // texels in regions that other triangles use as cut-outs, and between its painted regions; a
  // look-up at a triangle's side may mix in some of those, which are not meant.
  kOpaque,
  // The opacity is the same all over the triangle: it has no texture with translucent texels, or
  // the opacities of the texels within it differ by less than 1/100.
  kEven,
  kVaries,
};

// By [part][triangle].
std::vector<std::vector<Opacity>> opacities(const model::Mesh& mesh);

}  // namespace airtruth::shade
