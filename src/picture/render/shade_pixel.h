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
               const shade::Light& light)
      : triangles_(triangles), instances_(instances), rays_(rays), light_(light) {}

  PixelLight light_of(const Visibility& visibility, int x, int y);

 private:
  // A surface at the middle of what is visible of it.
  struct Lit {
    const VisibleSurface* visible;
    const PlacedInstance* placed;
    shade::Hit hit;
    float distance_m;
    shade::Surface surface;
    shade::Sunlit sunlit;
    // Of the rays to the sun from what is visible, those that nothing blocks.
    float sun_rays = 0;
    float open_sun_rays = 0;
  };
  Lit lit_at(const Visibility& visibility, const VisibleSurface& visible, int x, int y) const;
  // The barycentric weights of the second and the third corner at a place, and the point in body.
  std::array<float, 2> weights_at(const Visibility& visibility,
                                  const VisibleSurface& visible,
                                  const PixelPlace& at) const;
  Eigen::Vector3f in_body(const VisibleSurface& visible, const std::array<float, 2>& weights) const;
  void find_shadows(const Visibility& visibility);
  shade::Texel albedo_of(const Visibility& visibility, const Lit& lit) const;

  const RayTriangles& triangles_;
  const std::vector<PlacedInstance>& instances_;
  const PixelRays& rays_;
  const shade::Light& light_;
  // Of the pixel.
  std::vector<Lit> lit_;
  std::vector<shade::BodyRay> to_sun_;
  std::vector<std::uint32_t> of_ray_;
  std::vector<std::uint8_t> blocked_;
};

}  // namespace airtruth::render
