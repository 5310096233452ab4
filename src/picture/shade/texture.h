// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "picture/shade/model_impl.h"

namespace airtruth::shade {

using model::Texel;

// The texture of a triangle at the mip level nearest to one footprint (Williams 1983).
class TriangleTexture {
 public:
  // References mesh and facet. `footprint_m`: the width on the surface that a sample represents.
  TriangleTexture(const model::Mesh& mesh, const Facet& facet, float footprint_m);
  // By barycentric coordinates, as in Hit; white without a texture.
  float alpha(float u, float v) const;
  // Without the holes that a coarse mip level mixes into an opaque triangle's own texels.
  Texel albedo(float u, float v) const;

 private:
  Eigen::Vector2f uv(float u, float v) const;

  const Facet* facet_;
  // Null for a material without a texture.
  const model::Texture* texture_ = nullptr;
  std::size_t level_ = 0;
};

}  // namespace airtruth::shade
