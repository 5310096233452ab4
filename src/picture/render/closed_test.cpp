// SPDX-License-Identifier: Apache-2.0
#include "picture/render/closed.h"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "picture/render/cube_test_mesh.h"

namespace airtruth::render {
namespace {

using Signs = std::vector<std::int8_t>;

Signs outward_of(const aircraft::Mesh& mesh) {
  const std::vector<std::uint8_t> opaque(mesh.parts[0].triangles.size(), 1);
  return outward_normals(mesh, surfaces_of(mesh), {opaque})[0];
}

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
  EXPECT_EQ(outward_normals(mesh, surfaces_of(mesh), {opaque})[0], Signs(12, 0));
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

}  // namespace
}  // namespace airtruth::render
