// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "picture/render/coat.h"
#include "picture/render/model.h"

namespace airtruth::render {

// A ray in body coordinates that starts near the aircraft. Its distances count from that start.
struct BodyRay {
  Eigen::Vector3f origin;
  Eigen::Vector3f direction;  // unit
};

// An instance with the transforms that ray queries need.
struct Placed {
  const Model::Impl* model = nullptr;
  Eigen::Vector3f to_sun_in_body{0, 0, -1};
  Eigen::Vector3f up_in_body{0, 0, -1};
  Eigen::Matrix3f world_from_body = Eigen::Matrix3f::Identity();
  double time_s = 0;
  std::vector<Eigen::Affine3f> part_from_body;  // at that time
  std::vector<Eigen::Affine3f> body_from_part;
};

// A texture's value: linear RGBA, premultiplied.
using Texel = std::array<float, 4>;

// The texture of a triangle at the mip levels of one footprint (Williams 1983).
class Skin {
 public:
  // Of the triangle that is hit. `footprint_m`: the width on the surface that a sample represents.
  Skin(const Placed& placed, const Hit& hit, float footprint_m);
  // By barycentric coordinates, as in Hit; white without a texture.
  Texel texel(float u, float v) const;
  // The same, without the holes that a coarse mip level mixes into an opaque triangle's own texels.
  Texel albedo(float u, float v) const;
  const aircraft::Material& material() const { return *material_; }

 private:
  const aircraft::Material* material_ = nullptr;
  // Null for a material without a texture.
  const aircraft::Texture* texture_ = nullptr;
  std::array<Eigen::Vector2f, 3> uvs_;
  bool is_opaque_ = true;
  std::size_t level_ = 0;
  // Share of the next coarser level.
  float coarser_ = 0;
};

// Opacity of the surface at a hit, texture included.
float opacity_at(const Placed& placed, const Hit& hit, float footprint_m);

// The light of the surroundings at a point of a surface.
struct Around {
  // What reaches the paint (over pi).
  Rgb diffuse{};
  // What the coat mirrors to the eye; 0 without light.surroundings.
  Rgb mirrored{};
};

// The surroundings are light.surroundings, less the part that the aircraft hides from itself
// (openness.h), with a clear coat that mirrors them (Fresnel, by Schlick 1994). Without
// light.surroundings they are a hemisphere whose colour changes linearly from ground to sky.
// `view` points from the camera to the surface, in body.
Around around_at(const Placed& placed,
                 const Eigen::Vector3f& view,
                 const Hit& hit,
                 const Light& light);

// The light of the sun at a point of a surface, if nothing hides the sun. Lambert's law gives the
// diffuse light; both sides of a surface are lit.
struct Sunlit {
  // Unit vector of the triangle towards the viewer's side.
  Eigen::Vector3f face{0, 0, -1};
  // Irradiance over pi on the paint for a sun of 1.
  float sun = 0;
  // The cosine between the view and the normal.
  float cosine = 1;
  // Under light.surroundings, of a coat; otherwise its strength is that of Blinn-Phong (Blinn
  // 1977).
  Glint glint;
};
Sunlit sunlit_at(const Placed& placed,
                 const Eigen::Vector3f& view,
                 const Hit& hit,
                 const Light& light);

// The ray from the surface to the sun: where the aircraft blocks it, the surface is in shadow.
BodyRay to_sun_from(const Placed& placed, const BodyRay& ray, const Hit& hit, const Sunlit& sunlit);

// The light of a surface: linear, premultiplied by opacity.
Rgb colour_of(const aircraft::Material& material,
              const Texel& texel,
              const Around& around,
              const Sunlit& sunlit,
              bool in_shadow,
              const Light& light);

// The light of a surface at a hit, with the aircraft's own shadow.
std::array<float, 3> shade(const Placed& placed,
                           const BodyRay& ray,
                           const Hit& hit,
                           const Light& light,
                           float footprint_m);

}  // namespace airtruth::render
