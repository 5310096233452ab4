// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "picture/render/shade.h"

// What a smooth surface mirrors: a clear coat, glass, metal.
namespace airtruth::render {

// How a surface deals with light, by its finish.
struct Coat {
  std::array<float, 3> at_normal{};  // mirrored of what comes along the normal
  float roughness = 0.1f;            // GGX's alpha
  bool mirrors = true;
  float cover = 1;                   // where there is something that mirrors, 0..1
  std::array<float, 3> scattered{};  // of what is not mirrored; premultiplied by opacity
};
// texel: of its texture, premultiplied; white where there is none.
Coat coat_of(const aircraft::Material& material, const std::array<float, 4>& texel);

// Share of the light that is mirrored, by the cosine between the view (or the light) and the
// mirror's normal (Schlick 1994). `at_normal`: along the normal.
inline float mirror_share(float at_normal, float cosine) {
  const float off = 1 - cosine;
  const float squared = off * off;
  return at_normal + (1 - at_normal) * squared * squared * off;
}

// The sun's glint on microfacets (Walter et al. 2007, eq. 20 and 33, with the shadowing of Hammon
// 2017): what of the sun's irradiance over pi on a surface square to it comes back as radiance if
// all of it were mirrored, and the cosine that mirror_share() wants. `view` comes from the camera.
// 0 where the sun or the camera is behind the surface. roughness: GGX's alpha, above 0 to 1.
struct Glint {
  float strength = 0;
  float cosine = 1;
};
Glint sun_glint(const Eigen::Vector3f& normal,
                const Eigen::Vector3f& to_sun,
                const Eigen::Vector3f& view,
                float roughness);

}  // namespace airtruth::render
