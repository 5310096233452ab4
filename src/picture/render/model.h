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

// Only this module's sources include Embree.
namespace airtruth::render {

struct OpennessCache;
enum OuterSides : std::uint8_t;

struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

// The open share of the directions above a point; model_openness() in openness.h computes it.
struct Openness {
  float share = 1;  // 0..1
  // The cosine-weighted sum of the open unit directions as a share of all directions: 2/3 of the
  // normal where nothing is hidden.
  Eigen::Vector3f towards{0, 0, 0};
  // Light that the hiding parts reflect: the length is the share of the irradiance on a surface
  // whose normal is this direction.
  Eigen::Vector3f given_back{0, 0, 0};
};
struct SideOpenness {
  std::array<Openness, 3> corner;

  // Barycentric coordinates, as in Hit.
  Openness at(float u, float v) const {
    const auto mean = [&](const auto& of) {
      return (1 - u - v) * of(corner[0]) + u * of(corner[1]) + v * of(corner[2]);
    };
    return {mean([](const Openness& o) { return o.share; }),
            mean([](const Openness& o) -> const Eigen::Vector3f& { return o.towards; }),
            mean([](const Openness& o) -> const Eigen::Vector3f& { return o.given_back; })};
  }
};
struct TriangleOpenness {
  // The side to which the triangle's own normal points.
  SideOpenness front;
  SideOpenness back;
};

// A triangle as the shading reads it, in its part's coordinates.
struct Facet {
  std::array<Eigen::Vector3f, 3> corner;
  std::array<Eigen::Vector3f, 3> normal;  // of the smooth surface
  std::array<Eigen::Vector2f, 3> uv;
  // Unit normal of the triangle.
  Eigen::Vector3f face;
  float texels_per_m = 0;  // 0 without a texture
  std::uint32_t material = 0;
  bool is_opaque = true;
  // Whether the opacity is the same all over the triangle, and which it is then.
  bool is_even = true;
  float even_opacity = 1;
};

// A part's own vertices and triangles, without what only the shading needs.
struct PartGeometry {
  std::vector<Eigen::Vector3f> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct Model::Impl {
  explicit Impl(std::shared_ptr<const aircraft::Mesh> shared)
      : owned(std::move(shared)), mesh(*owned) {}

  std::shared_ptr<const aircraft::Mesh> owned;
  const aircraft::Mesh& mesh;
  std::unique_ptr<RTCDeviceTy, ReleaseDevice> device;
  // One BVH for each part, in the part's own coordinates; primitive k is parts[i].triangles[k].
  std::vector<std::unique_ptr<RTCSceneTy, ReleaseScene>> scenes;
  std::vector<std::vector<Facet>> facets;  // [part][triangle]
  std::vector<PartGeometry> geometry;      // [part]
  // By [part][triangle]; 1 where the whole triangle is opaque.
  std::vector<std::vector<std::uint8_t>> opaque;
  std::vector<std::vector<TriangleOpenness>> openness;  // [part][triangle]
  std::vector<std::vector<OuterSides>> outer_sides;     // [part][triangle]: of outer_sides.h
  Eigen::Vector3d centre_in_body{0, 0, 0};
  // Radius of a sphere about the centre that contains every part at any angle.
  double radius_m = 0;

  // Sets the centre and the radius.
  void find_sphere();
  void find_openness(const OpennessCache& cache);
};

// The point where a ray meets a part. `t` is the distance along the ray; u and v are barycentric
// coordinates.
struct Hit {
  float t = 0;
  int part = 0;
  std::uint32_t triangle = 0;
  float u = 0;
  float v = 0;
};

// True where a part of the aircraft blocks the ray within `reach_m`. The ray is in body
// coordinates. Spinning parts do not block: most of a propeller's disc is air.
bool is_blocked(const Model::Impl& model,
                const Eigen::Vector3f& origin,
                const Eigen::Vector3f& direction,
                float reach_m = INFINITY);

// The nearest hit that is_blocked() counts, by its distance from the origin; empty where nothing
// blocks the ray.
std::optional<Hit> nearest_blocker(const Model::Impl& model,
                                   const Eigen::Vector3f& origin,
                                   const Eigen::Vector3f& direction,
                                   float reach_m);

}  // namespace airtruth::render
