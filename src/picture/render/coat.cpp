// SPDX-License-Identifier: Apache-2.0
#include "picture/render/coat.h"

#include <algorithm>

namespace airtruth::render {
namespace {

// Mirrored share along the normal for a refractive index of 1.5: clear coat and glass.
constexpr float kDielectric = 0.04f;
// GGX's alpha of paint and panes: it blurs a reflection by a few degrees.
constexpr float kCoatRoughness = 0.1f;
// GGX's alpha of rolled and handled sheet metal.
constexpr float kMetalRoughness = 0.3f;
// Albedo of a cabin behind its windows.
constexpr float kCabin = 0.05f;

}  // namespace

float roughness_of(const aircraft::Material& material) {
  return material.finish == aircraft::Finish::kMetal ? kMetalRoughness : kCoatRoughness;
}

Coat coat_of(const aircraft::Material& material, const std::array<float, 4>& texel) {
  using aircraft::Finish;
  Coat coat;
  // A pane mirrors in full, however little it hides.
  coat.cover = texel[3] * (material.finish == Finish::kGlass ? 1 : material.opacity);
  coat.mirrors = material.finish != Finish::kMat;
  for (std::size_t i = 0; i < 3; ++i) {
    const float colour = material.diffuse[i] * texel[i];
    coat.at_normal[i] = kDielectric;
    coat.scattered[i] = material.opacity * colour;
    if (material.finish == Finish::kGlass)
      coat.scattered[i] = material.opacity * std::min(colour, kCabin * texel[3]);
    if (material.finish == Finish::kMetal && texel[3] > 0)
      coat.at_normal[i] = std::min(1.0f, colour / texel[3]), coat.scattered[i] = 0;
  }
  return coat;
}

Glint sun_glint(const Eigen::Vector3f& normal,
                const Eigen::Vector3f& to_sun,
                const Eigen::Vector3f& view,
                float roughness) {
  const float to_light = normal.dot(to_sun);
  const float to_eye = -normal.dot(view);
  if (!(to_light > 0) || !(to_eye > 0)) return {};
  const Eigen::Vector3f half = (to_sun - view).normalized();
  const float across = normal.dot(half);
  const float squared = roughness * roughness;
  const float spread = across * across * (squared - 1) + 1;
  // D over pi, and the visibility: the shadowing term over 4 cos cos.
  const float facets = squared / (spread * spread);
  const float visibility =
      0.5f / (2 * to_light * to_eye * (1 - roughness) + (to_light + to_eye) * roughness);
  return {facets * visibility * to_light, half.dot(to_sun)};
}

}  // namespace airtruth::render
