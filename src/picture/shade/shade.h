// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "aircraft/model/mesh.h"
#include "picture/shade/light.h"
#include "picture/shade/model_impl.h"
#include "picture/shade/texture.h"

// The light that a point of a surface sends to the eye, with the specular reflection of a clear
// coat, glass or metal.
namespace airtruth::shade {

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
float roughness_of(const model::Material& material);
// `texel`: the texture's value there, premultiplied; white for a material without a texture.
Coat coat_of(const model::Material& material, const std::array<float, 4>& texel);

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

// A ray in body coordinates that starts near the aircraft. Its distances count from that start.
struct BodyRay {
  Eigen::Vector3f origin;
  Eigen::Vector3f direction;  // unit
};

// An instance as the shading uses it.
struct Placed {
  const Model::Impl* model = nullptr;
  Eigen::Vector3f to_sun_in_body{0, 0, -1};
  Eigen::Vector3f up_in_body{0, 0, -1};
  // Light::surroundings by directions in body.
  std::optional<Environment> surroundings;
  // By part in the middle of the patch's span, then those of parts that turn, in the middle of each
  // of their spans.
  std::vector<Eigen::Affine3f> body_from_part;

  const Facet& facet(const Hit& hit) const {
    return model->facets[static_cast<std::size_t>(hit.part)][hit.triangle];
  }
  const model::Material& material(const Facet& of) const {
    return model->mesh.materials[of.material];
  }
};

// Opacity of a triangle at barycentric weights, texture included.
float opacity_at(const model::Mesh& mesh,
                 const Facet& facet,
                 const model::Material& material,
                 float u,
                 float v,
                 float footprint_m);

// A point of the surface in body coordinates, as the shading uses it. Both sides of a surface are
// lit.
struct Surface {
  // Unit vector of the triangle towards the viewer's side.
  Eigen::Vector3f face;
  // Unit vector of the smooth surface, on the same side as `face`.
  Eigen::Vector3f normal;
  bool is_back = false;
  // From the camera to the surface.
  Eigen::Vector3f view;
  // The cosine between the view and the normal.
  float cosine = 1;
};
// body_from_part: of the hit part.
Surface surface_at(const Placed& placed,
                   const Eigen::Affine3f& body_from_part,
                   const Eigen::Vector3f& view,
                   const Hit& hit);

// The light of the surroundings at a point of a surface.
struct Around {
  // What falls on the paint (over pi).
  Rgb diffuse{};
  // What the coat mirrors to the eye; 0 without surroundings.
  Rgb mirrored{};
};

// The surroundings are Placed::surroundings, less the part that the aircraft hides from itself
// (ambient_occlusion.h), with a clear coat that mirrors them (Fresnel, by Schlick 1994). Without
// surroundings they are a hemisphere whose colour changes linearly from ground to sky.
Around around_at(const Placed& placed, const Surface& surface, const Hit& hit, const Light& light);

// The light of the sun at a point of a surface, if nothing hides the sun. Lambert's law gives the
// diffuse light.
struct Sunlit {
  // Irradiance over pi on the paint for a sun of 1.
  float sun = 0;
  // Under Placed::surroundings, of a coat; otherwise its strength is that of Blinn-Phong (Blinn
  // 1977).
  Glint glint;
};
Sunlit sunlit_at(const Placed& placed, const Surface& surface, const model::Material& material);

// The ray from a point of the surface to the sun: where the aircraft blocks it, the surface is in
// shadow.
BodyRay to_sun_from(const Placed& placed,
                    const Eigen::Vector3f& point_in_body,
                    const Surface& surface);

// What a point of a surface sends light by.
struct LitPoint {
  const model::Material& material;
  const Texel& texel;
  const Around& around;
  const Sunlit& sunlit;
  float cosine;  // of Surface
  bool in_shadow;
};
// Its light: linear, premultiplied by opacity.
Rgb colour_of(const LitPoint& point, const Light& light);

}  // namespace airtruth::shade
