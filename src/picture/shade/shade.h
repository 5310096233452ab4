// SPDX-License-Identifier: Apache-2.0
#pragma once

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

// A glint of the sun. `strength`: the radiance that comes back if the surface mirrors all light, as
// a multiple of the sun's irradiance over pi on a surface that faces it. `cosine`: between the
// light and the mirror's normal.
struct Glint {
  float strength = 0;
  float cosine = 1;
};

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
