// SPDX-License-Identifier: Apache-2.0
#include "picture/shade/shade.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace airtruth::shade {
namespace {

// Where a constant of this file states no origin, it is a choice; docs/decisions/0019 compares the
// result with a path tracer.

// Mirrored share along the normal for a refractive index of 1.5: clear coat and glass.
constexpr float kDielectric = 0.04f;
// GGX's alpha of paint and panes: it blurs a reflection by a few degrees.
constexpr float kCoatRoughness = 0.1f;
// GGX's alpha of rolled and handled sheet metal.
constexpr float kMetalRoughness = 0.3f;
// Albedo, a ratio, of a cabin behind its windows.
constexpr float kCabin = 0.05f;

// GGX's alpha of the material's finish.
float roughness_of(const model::Material& material) {
  return material.finish == model::Finish::kMetal ? kMetalRoughness : kCoatRoughness;
}

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

// `texel`: the texture's value there, premultiplied; white for a material without a texture.
Coat coat_of(const model::Material& material, const std::array<float, 4>& texel) {
  using model::Finish;
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

// Mirrored share of the light by the cosine between the view (or the light) and the mirror's normal
// (Schlick 1994). `at_normal`: the share along the normal.
float mirror_share(float at_normal, float cosine) {
  const float off = 1 - cosine;
  const float squared = off * off;
  return at_normal + (1 - at_normal) * squared * squared * off;
}

// The sun's glint on microfacets (Walter et al. 2007, eq. 20 and 33, with the shadowing of Hammon
// 2017). `view` points from the camera to the surface. The strength is 0 where the sun or the
// camera is behind the surface. roughness: GGX's alpha, above 0 and up to 1.
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

}  // namespace

float opacity_at(const model::Mesh& mesh,
                 const Facet& facet,
                 const model::Material& material,
                 float u,
                 float v,
                 float footprint_m) {
  if (facet.is_opaque) return 1;
  const bool textured = mesh.has_translucent_texels(material);
  const float alpha =
      material.opacity * (textured ? TriangleTexture(mesh, facet, footprint_m).alpha(u, v) : 1.0f);
  return alpha >= model::kOpaque ? 1.0f : alpha;
}

Surface surface_at(const Placed& placed,
                   const Eigen::Affine3f& body_from_part,
                   const Eigen::Vector3f& view,
                   const Hit& hit) {
  const Facet& facet = placed.facet(hit);
  const auto linear = body_from_part.linear();
  Surface surface;
  surface.view = view;
  surface.face = linear * facet.face;
  surface.is_back = surface.face.dot(view) > 0;
  if (surface.is_back) surface.face = -surface.face;
  surface.normal = linear * ((1 - hit.u - hit.v) * facet.normal[0] + hit.u * facet.normal[1] +
                             hit.v * facet.normal[2]);
  const float squared = surface.normal.squaredNorm();
  if (squared > 1e-12f)
    surface.normal *= 1 / std::sqrt(squared);
  else
    surface.normal = surface.face;
  if (surface.normal.dot(surface.face) < 0) surface.normal = -surface.normal;
  surface.cosine = std::clamp(-surface.normal.dot(view), 0.0f, 1.0f);
  return surface;
}

namespace {

AmbientOcclusion occlusion_of(const Placed& placed, const Hit& hit, const Surface& surface) {
  const TriangleOcclusion& both =
      placed.model->occlusion[static_cast<std::size_t>(hit.part)][hit.triangle];
  return (surface.is_back ? both.back : both.front).at(hit.u, hit.v);
}

// Blinn-Phong with a normalisation: a shinier surface has a smaller and brighter glint.
float glint_of(const Surface& surface, const Eigen::Vector3f& to_sun, float shininess) {
  if (!(shininess > 0)) return 0;
  const Eigen::Vector3f half = (to_sun - surface.view).normalized();
  const float exponent = std::clamp(shininess, 4.0f, 128.0f);
  return (exponent + 8) / 25.0f * std::pow(std::max(0.0f, surface.normal.dot(half)), exponent);
}

// Light that the aircraft's own paint reflects to the surface, over pi.
Rgb given_back(const Placed& placed, const Eigen::Vector3f& share_towards, const Light& light) {
  const float share = share_towards.norm();
  if (!(share > 1e-3f)) return {};
  Rgb result = placed.surroundings->irradiance_over_pi(share_towards / share);
  const float sun = std::max(0.0f, share_towards.dot(placed.to_sun_in_body));
  for (std::size_t i = 0; i < 3; ++i) result[i] = share * result[i] + sun * light.sun[i];
  return result;
}

// The aircraft hides a share of the light of the surroundings and reflects some of its own. The
// mean direction of the remaining light leans away from the hiding parts.
Around light_around(const Placed& placed,
                    const Surface& surface,
                    const AmbientOcclusion& occlusion,
                    const Eigen::Vector3f& mirror,
                    const Light& light) {
  const float open = occlusion.open_share;
  Around around;
  around.mirrored = placed.surroundings->radiance(mirror);
  if (occlusion.is_open()) {
    around.diffuse = placed.surroundings->irradiance_over_pi(surface.normal);
    return around;
  }
  // The directions about the smooth normal lean in the same way as those about the face's normal.
  const Eigen::Vector3f lean = occlusion.towards + 2 * open / 3 * (surface.normal - surface.face);
  const Eigen::Vector3f towards = lean.norm() > 1e-6f ? lean.normalized() : surface.normal;
  around.diffuse = placed.surroundings->irradiance_over_pi(towards);
  const Rgb own = given_back(placed, occlusion.given_back, light);
  for (std::size_t i = 0; i < 3; ++i) {
    around.diffuse[i] = open * around.diffuse[i] + own[i];
    around.mirrored[i] = open * around.mirrored[i] + own[i];
  }
  return around;
}

// A sky whose colour changes linearly from ground to zenith (hemisphere lighting).
Rgb hemisphere(const Placed& placed, const Surface& surface, const Light& light) {
  const float upward = 0.5f * (1 + surface.normal.dot(placed.up_in_body));
  Rgb result;
  for (std::size_t i = 0; i < 3; ++i)
    result[i] = light.ground[i] + upward * (light.sky[i] - light.ground[i]);
  return result;
}

// Irradiance over pi on the paint for a sun of 1 that nothing hides.
float sun_on(const Placed& placed, const Surface& surface) {
  const Eigen::Vector3f& to_sun = placed.to_sun_in_body;
  const float cosine = surface.normal.dot(to_sun);
  return cosine > 0 && surface.face.dot(to_sun) > 0 ? cosine : 0;
}

Rgb as_opengl(const LitPoint& point, float sun, const Light& light) {
  const auto& [material, texel, around, sunlit, cosine, in_shadow] = point;
  // Share of painted metal. It replaces the specular colours of the model files, which are chosen
  // for the look of the game.
  constexpr float kGlossShare = 0.08f;
  const float glint = sun * sunlit.glint.strength;
  Rgb rgb;
  for (std::size_t i = 0; i < 3; ++i)
    rgb[i] = material.opacity *
             (material.diffuse[i] * texel[i] * (sun * light.sun[i] + around.diffuse[i]) +
              texel[3] * kGlossShare * material.specular[i] * glint * light.sun[i]);
  return rgb;
}

// A surface that mirrors a share of the light and scatters part of the rest. Premultiplied.
Rgb coated(const LitPoint& point, float sun, const Light& light) {
  const auto& [material, texel, around, sunlit, cosine, in_shadow] = point;
  const Coat coat = coat_of(material, texel);
  const float glint = sunlit.sun > 0 ? sun / sunlit.sun * sunlit.glint.strength : 0;
  Rgb rgb;
  for (std::size_t i = 0; i < 3; ++i) {
    const float share = coat.mirrors ? mirror_share(coat.at_normal[i], cosine) : 0;
    const float of_sun =
        coat.mirrors ? mirror_share(coat.at_normal[i], sunlit.glint.cosine) * glint : 0;
    rgb[i] = coat.scattered[i] * (1 - share) * (sun * light.sun[i] + around.diffuse[i]) +
             coat.cover * (share * around.mirrored[i] + of_sun * light.sun[i]);
  }
  return rgb;
}

}  // namespace

Around around_at(const Placed& placed, const Surface& surface, const Hit& hit, const Light& light) {
  if (!placed.surroundings) return {hemisphere(placed, surface, light), {}};
  const Eigen::Vector3f mirror = (surface.view + 2 * surface.cosine * surface.normal).normalized();
  return light_around(placed, surface, occlusion_of(placed, hit, surface), mirror, light);
}

Sunlit sunlit_at(const Placed& placed, const Surface& surface, const model::Material& material) {
  Sunlit lit;
  lit.sun = sun_on(placed, surface);
  if (!(lit.sun > 0)) return lit;
  if (placed.surroundings)
    lit.glint =
        sun_glint(surface.normal, placed.to_sun_in_body, surface.view, roughness_of(material));
  else
    lit.glint.strength = glint_of(surface, placed.to_sun_in_body, material.shininess);
  return lit;
}

BodyRay to_sun_from(const Placed& placed,
                    const Eigen::Vector3f& point_in_body,
                    const Surface& surface) {
  // Height of the start above the surface, so that rounding does not put the surface in its own
  // shadow.
  constexpr float kStartM = 0.01f;
  return {point_in_body + kStartM * surface.face, placed.to_sun_in_body};
}

Rgb colour_of(const LitPoint& point, const Light& light) {
  const float sun = point.in_shadow ? 0 : point.sunlit.sun;
  return light.surroundings ? coated(point, sun, light) : as_opengl(point, sun, light);
}

}  // namespace airtruth::shade
