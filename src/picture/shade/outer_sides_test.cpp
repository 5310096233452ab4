// SPDX-License-Identifier: Apache-2.0
#include "picture/shade/outer_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "aircraft/fleet/fleet.h"
#include "aircraft/model/mesh.h"
#include "picture/shade/model_impl.h"
#include "picture/shade/trace.h"

namespace airtruth::shade {
namespace {

// Adds a triangle with vertices of its own to the first part.
void add_triangle(model::Mesh& mesh, const std::array<Eigen::Vector3f, 3>& corners) {
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
  mesh.normals.resize(mesh.positions.size(), Eigen::Vector3f(1, 0, 0));
  mesh.uvs.resize(mesh.positions.size(), Eigen::Vector2f(0, 0));
  mesh.parts[0].triangles.push_back({{base, base + 1, base + 2}, 0});
}

// A cube about the origin, with sides of 2 m; each side has two triangles, whose normals point
// outwards. Each triangle has vertices of its own, as in meshes with hard edges.
model::Mesh cube() {
  model::Mesh mesh;
  mesh.materials.emplace_back();
  mesh.parts.push_back({.name = "cube"});
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0F, 1.0F}) {
      const auto at = [&](float u, float v) {
        Eigen::Vector3f p;
        p[axis] = side;
        p[(axis + 1) % 3] = u;
        p[(axis + 2) % 3] = side * v;
        return p;
      };
      add_triangle(mesh, {at(-1, -1), at(1, -1), at(1, 1)});
      add_triangle(mesh, {at(-1, -1), at(1, 1), at(-1, 1)});
    }
  return mesh;
}

void turn(model::Triangle& triangle) { std::swap(triangle.vertex[0], triangle.vertex[1]); }

using Signs = std::vector<std::int8_t>;

Signs outward_of(const model::Mesh& mesh) {
  const std::vector<std::uint8_t> opaque(mesh.parts[0].triangles.size(), 1);
  return outward_normals(mesh, surfaces_of(mesh), {opaque})[0];
}

TEST(Closed, ACubesNormalsPointOutwards) { EXPECT_EQ(outward_of(cube()), Signs(12, 1)); }

TEST(Closed, NormalsThatPointInwardsAreFoundAllOrOne) {
  model::Mesh mesh = cube();
  turn(mesh.parts[0].triangles[4]);
  Signs expected(12, 1);
  expected[4] = -1;
  EXPECT_EQ(outward_of(mesh), expected);
  for (std::size_t t = 0; t < 12; ++t)
    if (t != 4) turn(mesh.parts[0].triangles[t]);
  EXPECT_EQ(outward_of(mesh), Signs(12, -1));
}

TEST(Closed, AHoleOpensTheWholeSurface) {
  model::Mesh mesh = cube();
  mesh.parts[0].triangles.pop_back();
  EXPECT_EQ(outward_of(mesh), Signs(11, 0));
}

TEST(Closed, OneTranslucentTriangleOpensTheWholeSurface) {
  const model::Mesh mesh = cube();
  std::vector<std::uint8_t> opaque(12, 1);
  opaque[7] = 0;
  EXPECT_EQ(outward_normals(mesh, surfaces_of(mesh), {opaque})[0], Signs(12, 0));
}

TEST(Closed, ASheetWithTwoSidesEnclosesNothing) {
  model::Mesh mesh = cube();
  auto& triangles = mesh.parts[0].triangles;
  triangles.resize(2);
  for (std::size_t t = 0; t < 2; ++t) {
    triangles.push_back(triangles[t]);
    turn(triangles.back());
  }
  EXPECT_EQ(outward_of(mesh), Signs(4, 0));
}

}  // namespace

namespace {

using Outer = std::vector<OuterSides>;

// Two triangles between four corners, which are given along the outline.
void add_quad(model::Mesh& mesh, const std::array<Eigen::Vector3f, 4>& corners) {
  add_triangle(mesh, {corners[0], corners[1], corners[2]});
  add_triangle(mesh, {corners[0], corners[2], corners[3]});
}

// A square plate at right angles to x, with sides of `size`; its front looks towards +x.
void add_plate(model::Mesh& mesh, float x, float size) {
  const float h = size / 2;
  add_quad(mesh, {{{x, -h, -h}, {x, h, -h}, {x, h, h}, {x, -h, h}}});
}

// A strip that is turned by half a turn on its way round (Moebius 1858), 1 m across.
void add_strip_of_one_side(model::Mesh& mesh) {
  constexpr int kSteps = 12;
  const auto rim = [](int step, float side) -> Eigen::Vector3f {
    // The end joins the beginning with its rims exchanged, by the same numbers.
    const bool is_end = step == kSteps;
    const float round =
        is_end ? 0.0F : 2 * static_cast<float>(kPi) * static_cast<float>(step) / kSteps;
    const float r = 0.4F + 0.1F * (is_end ? -side : side) * std::cos(round / 2);
    return {r * std::cos(round),
            r * std::sin(round),
            0.1F * (is_end ? -side : side) * std::sin(round / 2)};
  };
  for (int k = 0; k < kSteps; ++k)
    add_quad(mesh, {{rim(k, -1), rim(k, 1), rim(k + 1, 1), rim(k + 1, -1)}});
}

// The cube without its side x = -1.
model::Mesh open_cube() {
  model::Mesh mesh = cube();
  auto& triangles = mesh.parts[0].triangles;
  triangles.erase(triangles.begin(), triangles.begin() + 2);
  return mesh;
}

Outer outer_of(const model::Mesh& mesh) { return Model(mesh).impl().outer_sides[0]; }

Outer from(const Outer& outer, std::size_t first) {
  return {outer.begin() + static_cast<std::ptrdiff_t>(first), outer.end()};
}

TEST(OuterSides, AreTheOuterOnesOfAClosedSurface) {
  EXPECT_EQ(outer_of(cube()), Outer(12, kFrontSide));
  model::Mesh turned = cube();
  turn(turned.parts[0].triangles[4]);
  Outer expected(12, kFrontSide);
  expected[4] = kBackSide;
  EXPECT_EQ(outer_of(turned), expected);
}

TEST(OuterSides, AreBothWhereASurfaceIsOpen) {
  EXPECT_EQ(outer_of(open_cube()), Outer(10, kBothSides));
}

// A plate closes the cube, though no vertex of it is one of the cube's.
TEST(OuterSides, AreTheOuterOnesWhereAnOpenSurfaceIsCovered) {
  model::Mesh mesh = open_cube();
  add_plate(mesh, -1, 2.2F);
  Outer expected(12, kFrontSide);
  expected[10] = expected[11] = kBackSide;
  EXPECT_EQ(outer_of(mesh), expected);
  // A smaller one leaves a gap. Rays leave through it from within the cube, but none from the inner
  // side of the plate.
  model::Mesh with_gap = open_cube();
  add_plate(with_gap, -1, 1.8F);
  Outer seen_through_gap(12, kBothSides);
  seen_through_gap[10] = seen_through_gap[11] = kBackSide;
  EXPECT_EQ(outer_of(with_gap), seen_through_gap);
}

TEST(OuterSides, AreNoneWithinAClosedSurface) {
  model::Mesh mesh = cube();
  add_plate(mesh, 0, 1);
  EXPECT_EQ(from(outer_of(mesh), 12), Outer(2, kNoSide));
  // A closed surface within another.
  const model::Mesh inner = cube();
  model::Mesh nested = cube();
  for (const model::Triangle& triangle : inner.parts[0].triangles) {
    const auto& [a, b, c] = triangle.vertex;
    add_triangle(nested,
                 {0.5F * inner.positions[a], 0.5F * inner.positions[b], 0.5F * inner.positions[c]});
  }
  Outer expected(24, kFrontSide);
  for (std::size_t t = 12; t < 24; ++t) expected[t] = kNoSide;
  EXPECT_EQ(outer_of(nested), expected);
}

TEST(OuterSides, AreBothBehindAPane) {
  model::Mesh mesh = open_cube();
  mesh.materials.emplace_back().opacity = 0.5F;
  add_plate(mesh, -1, 2.2F);
  for (std::size_t t = 10; t < 12; ++t) mesh.parts[0].triangles[t].material = 1;
  EXPECT_EQ(outer_of(mesh), Outer(12, kBothSides));
}

TEST(OuterSides, AreBothOfASurfaceWithOneSideOnly) {
  model::Mesh mesh = cube();
  add_strip_of_one_side(mesh);
  EXPECT_EQ(from(outer_of(mesh), 12), Outer(24, kBothSides));
}

// Whether an eye at one place or at three cannot see a triangle.
bool is_hidden_from(const model::Mesh& mesh,
                    const model::Triangle& triangle,
                    OuterSides outer,
                    const std::vector<Vector3>& eyes) {
  const auto& [a, b, c] = triangle.vertex;
  const Vector3 p = mesh.positions[a].cast<double>();
  const Vector3 front =
      (mesh.positions[b].cast<double>() - p).cross(mesh.positions[c].cast<double>() - p);
  std::vector<double> front_to_eye;
  double scale = 0;
  for (const Vector3& eye : eyes) {
    front_to_eye.push_back(front.dot(eye - p));
    scale = std::max(scale, front.norm() * (eye - p).norm());
  }
  return is_hidden(outer, front_to_eye, scale);
}

TEST(IsHidden, OfACubeAreThoseThatFaceAway) {
  const model::Mesh mesh = cube();
  // The eye is before the side x = 1 and above none of the others; or it moves from before the side
  // x = 1 to before the side y = 1: both are left at all times.
  const std::vector<Vector3> before = {Vector3(5, 0.5, -0.5)};
  const std::vector<Vector3> around = {Vector3(5, 0, 0), Vector3(4, 4, 0), Vector3(0, 5, 0)};
  for (std::size_t t = 0; t < 12; ++t) {
    const model::Triangle& triangle = mesh.parts[0].triangles[t];
    EXPECT_EQ(is_hidden_from(mesh, triangle, kFrontSide, before), t / 2 != 1) << t;
    EXPECT_EQ(is_hidden_from(mesh, triangle, kFrontSide, around), t / 2 != 1 && t / 2 != 3) << t;
  }
}

TEST(IsHidden, IsAllWithoutAnOuterSideAndNoneWithBoth) {
  const model::Mesh mesh = cube();
  for (const model::Triangle& triangle : mesh.parts[0].triangles) {
    EXPECT_TRUE(is_hidden_from(mesh, triangle, kNoSide, {Vector3(5, 0, 0)}));
    EXPECT_FALSE(is_hidden_from(mesh, triangle, kBothSides, {Vector3(5, 0, 0)}));
  }
}

// Embree's nearest hit of rays from all around never is a triangle that is left out.
TEST(IsHidden, IsNoTriangleThatRaysFromOutsideMeet) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (const char* name :
       {"738/738-Ryanair", "733/733-AirBaltic", "A300/A300-ACT-Cargo", "c172/news"}) {
    const Model model(fleet::load_aircraft(name).mesh);
    const Model::Impl& impl = model.impl();
    int hits = 0, of_one_side = 0;
    for (int i = 0; i < 20000; ++i) {
      const auto direction = [&] {
        return Vector3(normal(random), normal(random), normal(random)).normalized();
      };
      const Vector3 eye = impl.centre_in_body + 3 * impl.radius_m * direction();
      const Vector3 aim = impl.centre_in_body + 0.5 * impl.radius_m * direction();
      const BodyRay ray{eye.cast<float>(), (aim - eye).normalized().cast<float>()};
      const auto hit = nearest_blocker(impl, ray, INFINITY);
      if (!hit) continue;
      const auto part = static_cast<std::size_t>(hit->part);
      const OuterSides outer = impl.outer_sides[part][hit->triangle];
      EXPECT_FALSE(
          is_hidden_from(impl.mesh, impl.mesh.parts[part].triangles[hit->triangle], outer, {eye}))
          << name << ", triangle " << hit->triangle;
      ++hits;
      of_one_side += outer != kBothSides;
    }
    EXPECT_GT(hits, 500) << name;
    EXPECT_GT(of_one_side, 100) << name;
  }
}

}  // namespace

}  // namespace airtruth::shade
