// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include <embree3/rtcore.h>

#include "aircraft/model/mesh.h"
#include "picture/render/renderer.h"

// Embree stays in this module's sources.
namespace airtruth::render {

struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

// See openness.h.
struct Openness {
  float share = 1;  // 0..1
  // The sum of the open unit directions as a share of all, by cosine: 2/3 of the normal where
  // nothing is hidden.
  Eigen::Vector3f towards{0, 0, 0};
  // What hides the rest gives light back: this share (its length) of the irradiance on a surface
  // that faces this way.
  Eigen::Vector3f given_back{0, 0, 0};
};
struct SideOpenness {
  std::array<Openness, 3> corner;

  Openness at(float u, float v) const {  // barycentric, as of Hit
    const auto mean = [&](const auto& of) {
      return (1 - u - v) * of(corner[0]) + u * of(corner[1]) + v * of(corner[2]);
    };
    return {mean([](const Openness& o) { return o.share; }),
            mean([](const Openness& o) -> const Eigen::Vector3f& { return o.towards; }),
            mean([](const Openness& o) -> const Eigen::Vector3f& { return o.given_back; })};
  }
};
struct TriangleOpenness {
  SideOpenness front;  // the side that the triangle's own normal is on
  SideOpenness back;
};

struct Model::Impl {
  aircraft::Mesh mesh;
  std::unique_ptr<RTCDeviceTy, ReleaseDevice> device;
  // One BVH per part, in the part's own coordinates; primitive k is parts[i].triangles[k].
  std::vector<std::unique_ptr<RTCSceneTy, ReleaseScene>> scenes;
  std::vector<std::vector<float>> texels_per_m;  // [part][triangle], 0 without a texture
  std::vector<std::vector<std::uint8_t>>
      opaque;  // [part][triangle]: 1 where nothing shines through
  std::vector<std::vector<TriangleOpenness>> openness;  // [part][triangle]
  Eigen::Vector3d centre_in_body{0, 0, 0};
  double radius_m = 0;  // of a sphere about the centre that holds every part at any turn
};

// Where a ray meets a part.
struct Hit {
  float t = 0;
  int part = 0;
  std::uint32_t triangle = 0;
  float u = 0;
  float v = 0;
};

// Does anything of the aircraft stand in the way from there, within that reach? In body
// coordinates. What spins is left out: a propeller's disc is mostly air.
bool is_blocked(const Model::Impl& model,
                const Eigen::Vector3f& origin,
                const Eigen::Vector3f& direction,
                float reach_m = INFINITY);

// The nearest thing that is_blocked() counts, by its distance from the origin, if any.
std::optional<Hit> nearest_blocker(const Model::Impl& model,
                                   const Eigen::Vector3f& origin,
                                   const Eigen::Vector3f& direction,
                                   float reach_m);

}  // namespace airtruth::render
