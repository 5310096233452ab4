// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

#include "aircraft/model/mesh.h"

// Specular reflection of a smooth surface: a clear coat, glass or metal.
namespace airtruth::render {

// The reflection of a surface, by its finish.
struct Coat {
  // Mirrored share of the light that arrives along the normal.
  std::array<float, 3> at_normal{};
  // True where the surface has a specular reflection.
  bool mirrors = true;
  // Share of the surface that mirrors, 0..1.
  float cover = 1;
  // Colour of the light that is scattered and not mirrored; premultiplied by opacity.
  std::array<float, 3> scattered{};
};
// GGX's alpha of the material's finish.
float roughness_of(const aircraft::Material& material);
// `texel`: the texture's value there, premultiplied; white for a material without a texture.
Coat coat_of(const aircraft::Material& material, const std::array<float, 4>& texel);

// Mirrored share of the light by the cosine between the view (or the light) and the mirror's normal
// (Schlick 1994). `at_normal`: the share along the normal.
inline float mirror_share(float at_normal, float cosine) {
  const float off = 1 - cosine;
  const float squared = off * off;
  return at_normal + (1 - at_normal) * squared * squared * off;
}

// The sun's glint on microfacets (Walter et al. 2007, eq. 20 and 33, with the shadowing of Hammon
// 2017). `strength`: the radiance that comes back if the surface mirrors all light, as a multiple
// of the sun's irradiance over pi on a surface that faces it. `cosine`: the argument for
// mirror_share(). `view` points from the camera to the surface. The strength is 0 where the sun or
// the camera is behind the surface. roughness: GGX's alpha, above 0 and up to 1.
struct Glint {
  float strength = 0;
  float cosine = 1;
};
Glint sun_glint(const Eigen::Vector3f& normal,
                const Eigen::Vector3f& to_sun,
                const Eigen::Vector3f& view,
                float roughness);

}  // namespace airtruth::render
