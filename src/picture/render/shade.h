// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

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

// Opacity of the surface at a hit, texture included. `footprint_m`: the width on the surface that
// the sample represents.
float opacity_at(const Placed& placed, const Hit& hit, float footprint_m);

// The light of a surface at a hit: linear, premultiplied by opacity. Lambert's law gives the
// diffuse light of the sun (with the aircraft's own shadow) and of the surroundings; Blinn-Phong
// (Blinn 1977) gives the sun's glint. Both sides of a surface are lit.
//
// The surroundings are light.surroundings, less the part that the aircraft hides from itself
// (openness.h), with a clear coat that mirrors them (Fresnel, by Schlick 1994). Without
// light.surroundings they are a hemisphere whose colour changes linearly from ground to sky.
std::array<float, 3> shade(const Placed& placed,
                           const BodyRay& ray,
                           const Hit& hit,
                           const Light& light,
                           float footprint_m);

}  // namespace airtruth::render
