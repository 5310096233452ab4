// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "aircraft/model/mesh.h"
#include "picture/shade/embree.h"
#include "picture/shade/model.h"

// Only this module's sources include Embree.
namespace airtruth::shade {

enum OuterSides : std::uint8_t;

struct Device {
  Device(RTCDevice made, std::string named) : embree(made), name(std::move(named)) {}
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device() { rtcReleaseDevice(embree); }

  RTCDevice embree;
  std::string name;  // Embree's version and its settings
};
struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

// The open share of the directions above a point; model_occlusion() in ambient_occlusion.h computes
// it.
struct AmbientOcclusion {
  float open_share = 1;  // 0..1
  // The cosine-weighted sum of the open unit directions as a share of all directions: 2/3 of the
  // normal where nothing is hidden.
  Eigen::Vector3f towards{0, 0, 0};
  // Light that the hiding parts reflect: the length is the share of the irradiance on a surface
  // whose normal is this direction.
  Eigen::Vector3f given_back{0, 0, 0};

  // True where so little is hidden that nothing counts as hidden.
  bool is_open() const { return open_share > 0.999f; }
};
struct SideOcclusion {
  std::array<AmbientOcclusion, 3> corner;

  // Barycentric coordinates, as in Hit.
  AmbientOcclusion at(float u, float v) const {
    const auto mean = [&](const auto& of) {
      return (1 - u - v) * of(corner[0]) + u * of(corner[1]) + v * of(corner[2]);
    };
    return {mean([](const AmbientOcclusion& o) { return o.open_share; }),
            mean([](const AmbientOcclusion& o) -> const Eigen::Vector3f& { return o.towards; }),
            mean([](const AmbientOcclusion& o) -> const Eigen::Vector3f& { return o.given_back; })};
  }
};
struct TriangleOcclusion {
  // The side to which the triangle's own normal points.
  SideOcclusion front;
  SideOcclusion back;
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
  struct Triangle {
    std::array<std::uint32_t, 3> vertex;
    // Along its own normal; the length is twice its area.
    Eigen::Vector3d front_m2;
    // Its length, and that of the longest side.
    double front_length_m2;
    double longest_m;
  };
  std::vector<Eigen::Vector3f> positions;
  std::vector<Triangle> triangles;
};

struct Model::Impl {
  explicit Impl(std::shared_ptr<const model::Mesh> shared)
      : owned(std::move(shared)), mesh(*owned) {}

  std::shared_ptr<const model::Mesh> owned;
  const model::Mesh& mesh;
  std::shared_ptr<const Device> device;
  // One BVH for each part, in the part's own coordinates; primitive k is parts[i].triangles[k].
  std::vector<std::unique_ptr<RTCSceneTy, ReleaseScene>> scenes;
  std::vector<std::vector<Facet>> facets;  // [part][triangle]
  std::vector<PartGeometry> geometry;      // [part]
  // By [part][triangle]; 1 where the whole triangle is opaque.
  std::vector<std::vector<std::uint8_t>> opaque;
  std::vector<std::vector<TriangleOcclusion>> occlusion;  // [part][triangle]
  std::vector<std::vector<OuterSides>> outer_sides;       // [part][triangle]: of outer_sides.h
  Eigen::Vector3d centre_in_body{0, 0, 0};
  // Radius of a sphere about the centre that contains every part at any angle.
  double radius_m = 0;

  // Sets the centre and the radius.
  void find_sphere();
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

}  // namespace airtruth::shade
