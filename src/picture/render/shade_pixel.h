// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "picture/render/visibility.h"

namespace airtruth::render {

// The light of a pixel that was looked at: linear and premultiplied, and the sum of the surfaces'
// distances, each weighted by what it contributes to alpha.
struct PixelLight {
  std::array<double, 3> rgb{};
  double distance_m = 0;
};

// Computes the light of pixels: once for each surface that is visible in a pixel, at the middle of
// the samples that see it. Its texture is read at some of those samples, each with the width of its
// share of the pixel, and averaged.
class PixelShading {
 public:
  PixelShading(const RayTriangles& triangles,
               const std::vector<PlacedInstance>& instances,
               const PixelRays& rays,
               const Light& light)
      : triangles_(triangles), instances_(instances), rays_(rays), light_(light) {}

  PixelLight light_of(const Visibility& seen, int x, int y);

 private:
  // A surface at the middle of what is visible of it.
  struct Lit {
    const VisibleSurface* visible;
    const PlacedInstance* placed;
    Hit hit;
    float distance_m;
    Eigen::Vector3f in_body;
    Surface surface;
    Sunlit sunlit;
    bool in_shadow;
  };
  Lit lit_at(const Visibility& seen, const VisibleSurface& visible, int x, int y) const;
  void find_shadows();
  Texel albedo_of(const Visibility& seen, const Lit& lit) const;

  const RayTriangles& triangles_;
  const std::vector<PlacedInstance>& instances_;
  const PixelRays& rays_;
  const Light& light_;
  // Of the pixel.
  std::vector<Lit> lit_;
  std::vector<BodyRay> to_sun_;
  std::vector<std::uint32_t> of_ray_;
  std::vector<std::uint8_t> blocked_;
};

}  // namespace airtruth::render
