// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "picture/render/model.h"

namespace airtruth::render {

// A ray in body coordinates that begins near the aircraft; what it says of distance is from that
// beginning.
struct BodyRay {
  Eigen::Vector3f origin;
  Eigen::Vector3f direction;  // unit
};

// An instance as rays meet it.
struct Placed {
  const Model::Impl* model = nullptr;
  Eigen::Vector3f to_sun_in_body{0, 0, -1};
  Eigen::Vector3f up_in_body{0, 0, -1};
  Eigen::Matrix3f world_from_body = Eigen::Matrix3f::Identity();
  double time_s = 0;
  std::vector<Eigen::Affine3f> part_from_body;  // at that time
  std::vector<Eigen::Affine3f> body_from_part;
};

// Opacity of the surface at a hit, texture included. `footprint_m`: the width that a sample stands
// for, there.
float opacity_at(const Placed& placed, const Hit& hit, float footprint_m);

// Linear light, premultiplied by opacity: Lambert for the sun (with the aircraft's own shadow) and
// for what comes from all around, Blinn-Phong (Blinn 1977) for the sun's glint. Two-sided.
//
// What comes from all around is light.surroundings, less what the aircraft itself hides
// (openness.h), with a clear coat that mirrors it (Fresnel, by Schlick 1994); else a sky that goes
// evenly from ground to zenith colour (hemisphere lighting).
std::array<float, 3> shade(const Placed& placed,
                           const BodyRay& ray,
                           const Hit& hit,
                           const Light& light,
                           float footprint_m);

}  // namespace airtruth::render
