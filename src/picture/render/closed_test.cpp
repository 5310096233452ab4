// SPDX-License-Identifier: Apache-2.0
#include "picture/render/closed.h"

#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "aircraft/fleet/fleet.h"
#include "picture/render/model.h"

namespace airtruth::render {
namespace {

using Signs = std::vector<std::int8_t>;

// A cube of 2 m about the origin; each side has two triangles, whose normals point outwards. Each
// triangle has vertices of its own, as in meshes with hard edges.
aircraft::Mesh cube() {
  aircraft::Mesh mesh;
  mesh.materials.emplace_back();
  mesh.parts.push_back({.name = "cube"});
  const auto add = [&](std::array<Eigen::Vector3f, 3> corners) {
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
    mesh.parts[0].triangles.push_back({{base, base + 1, base + 2}, 0});
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0F, 1.0F}) {
      const auto at = [&](float u, float v) {
        Eigen::Vector3f p;
        p[axis] = side;
        p[(axis + 1) % 3] = u;
        p[(axis + 2) % 3] = side * v;
        return p;
      };
      add({at(-1, -1), at(1, -1), at(1, 1)});
      add({at(-1, -1), at(1, 1), at(-1, 1)});
    }
  mesh.normals.assign(mesh.positions.size(), Eigen::Vector3f(1, 0, 0));
  mesh.uvs.assign(mesh.positions.size(), Eigen::Vector2f(0, 0));
  return mesh;
}

Signs outward_of(const aircraft::Mesh& mesh) {
  return outward_normals(mesh, {std::vector<std::uint8_t>(mesh.parts[0].triangles.size(), 1)})[0];
}

void turn(aircraft::Triangle& triangle) { std::swap(triangle.vertex[0], triangle.vertex[1]); }

TEST(Closed, ACubesNormalsPointOutwards) { EXPECT_EQ(outward_of(cube()), Signs(12, 1)); }

TEST(Closed, NormalsThatPointInwardsAreFoundAllOrOne) {
  aircraft::Mesh mesh = cube();
  turn(mesh.parts[0].triangles[4]);
  Signs expected(12, 1);
  expected[4] = -1;
  EXPECT_EQ(outward_of(mesh), expected);
  for (std::size_t t = 0; t < 12; ++t)
    if (t != 4) turn(mesh.parts[0].triangles[t]);
  EXPECT_EQ(outward_of(mesh), Signs(12, -1));
}

TEST(Closed, AHoleOpensTheWholeSurface) {
  aircraft::Mesh mesh = cube();
  mesh.parts[0].triangles.pop_back();
  EXPECT_EQ(outward_of(mesh), Signs(11, 0));
}

TEST(Closed, OneTranslucentTriangleOpensTheWholeSurface) {
  const aircraft::Mesh mesh = cube();
  std::vector<std::uint8_t> opaque(12, 1);
  opaque[7] = 0;
  EXPECT_EQ(outward_normals(mesh, {opaque})[0], Signs(12, 0));
}

TEST(Closed, ASheetWithTwoSidesEnclosesNothing) {
  aircraft::Mesh mesh = cube();
  auto& triangles = mesh.parts[0].triangles;
  triangles.resize(2);
  for (std::size_t t = 0; t < 2; ++t) {
    triangles.push_back(triangles[t]);
    turn(triangles.back());
  }
  EXPECT_EQ(outward_of(mesh), Signs(4, 0));
}

TEST(Closed, OfACubeOnlySidesTowardsTheEyeAreLeft) {
  const aircraft::Mesh mesh = cube();
  const Signs outward = outward_of(mesh);
  // The eye is before the side x = 1 and above none of the others.
  const FacingAway from_front(mesh, mesh.parts[0], outward, {Vector3(5, 0.5, -0.5)});
  for (std::size_t t = 0; t < 12; ++t) EXPECT_EQ(from_front(t), t / 2 != 1) << t;
  // It moves from before the side x = 1 to before the side y = 1: both are left at all times.
  const FacingAway around(
      mesh, mesh.parts[0], outward, {Vector3(5, 0, 0), Vector3(4, 4, 0), Vector3(0, 5, 0)});
  for (std::size_t t = 0; t < 12; ++t) EXPECT_EQ(around(t), t / 2 != 1 && t / 2 != 3) << t;
}

// Embree's nearest hit of rays from all around never is a triangle that is left out.
TEST(Closed, NoVisibleTriangleOfAnAircraftIsLeftOut) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (const char* name : {"738/738-Ryanair", "A300/A300-ACT-Cargo", "c172/news"}) {
    const Model model(aircraft::load_aircraft(name).mesh);
    const Model::Impl& impl = model.impl();
    int hits = 0, of_closed = 0;
    for (int i = 0; i < 20000; ++i) {
      const auto direction = [&] {
        return Vector3(normal(random), normal(random), normal(random)).normalized();
      };
      const Vector3 eye = impl.centre_in_body + 3 * impl.radius_m * direction();
      const Vector3 aim = impl.centre_in_body + 0.5 * impl.radius_m * direction();
      const auto hit = nearest_blocker(
          impl, eye.cast<float>(), (aim - eye).normalized().cast<float>(), INFINITY);
      if (!hit) continue;
      const auto part = static_cast<std::size_t>(hit->part);
      const FacingAway away(impl.mesh, impl.mesh.parts[part], impl.outward[part], {eye});
      EXPECT_FALSE(away(hit->triangle)) << name << ", triangle " << hit->triangle;
      ++hits;
      of_closed += impl.outward[part][hit->triangle] != 0;
    }
    EXPECT_GT(hits, 500) << name;
    EXPECT_GT(of_closed, 100) << name;
  }
}

}  // namespace
}  // namespace airtruth::render
