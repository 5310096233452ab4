// SPDX-License-Identifier: Apache-2.0
#include "picture/shade/opaque.h"

#include <array>

#include <gtest/gtest.h>

#include "aircraft/model/texture.h"

namespace airtruth::shade {
namespace {

constexpr int kTexelsPerSide = 16;

// A texture of kTexelsPerSide x kTexelsPerSide texels whose columns from 8 on are transparent, and
// one triangle.
model::Mesh mesh_of(const std::array<Eigen::Vector2f, 3>& in_texels) {
  model::Mesh mesh;
  texture_file::Picture picture{kTexelsPerSide, kTexelsPerSide, {}};
  for (int i = 0; i < kTexelsPerSide * kTexelsPerSide; ++i)
    picture.rgba.insert(picture.rgba.end(), 4, i % kTexelsPerSide < 8 ? 255 : 0);
  mesh.textures.push_back(model::texture_from_picture(picture, true, true));
  mesh.materials.emplace_back();
  mesh.materials[0].texture = 0;
  mesh.parts.push_back({.name = "triangle", .triangles = {{{0, 1, 2}, 0}}});
  for (const Eigen::Vector2f& at : in_texels) {
    mesh.positions.emplace_back(0, at.x(), at.y());
    mesh.normals.emplace_back(1, 0, 0);
    mesh.uvs.push_back(at / kTexelsPerSide);
  }
  return mesh;
}

bool is_opaque(const std::array<Eigen::Vector2f, 3>& in_texels) {
  return opacities(mesh_of(in_texels))[0][0] == Opacity::kOpaque;
}

using V = Eigen::Vector2f;

TEST(Opaque, ATriangleUpToTheBorderOfItsRegionIsOpaque) {
  EXPECT_TRUE(is_opaque({V(1, 1), V(8, 1), V(8, 15)}));
}

TEST(Opaque, ATransparentTexelWithinATriangleIsSeen) {
  EXPECT_FALSE(is_opaque({V(1, 1), V(8.6F, 7.5F), V(1, 15)}));
  EXPECT_TRUE(is_opaque({V(1, 1), V(8.4F, 7.5F), V(1, 15)}));
}

// The box about the triangle has transparent texels, and the triangle has none.
TEST(Opaque, TransparentTexelsBesideASlantedTriangleDoNotCount) {
  EXPECT_TRUE(is_opaque({V(1, 1), V(7, 1), V(8.4F, 15)}));
  EXPECT_FALSE(is_opaque({V(1, 1), V(7, 1), V(12, 15)}));
}

TEST(Opaque, ATriangleSmallerThanATexelHasThatOfItsMiddle) {
  EXPECT_TRUE(is_opaque({V(7.6F, 3.1F), V(7.9F, 3.1F), V(7.9F, 3.3F)}));
  EXPECT_FALSE(is_opaque({V(8.1F, 3.1F), V(8.3F, 3.1F), V(8.3F, 3.3F)}));
}

TEST(Opaque, ARepeatedTextureIsTheSameEverywhere) {
  EXPECT_TRUE(is_opaque({V(33, 17), V(40, 17), V(40, 31)}));
  EXPECT_FALSE(is_opaque({V(41, 17), V(47, 17), V(47, 31)}));
  // Across the end of the texture.
  EXPECT_FALSE(is_opaque({V(15, 1), V(18, 1), V(18, 3)}));
}

TEST(Opaque, PaintThatPackingLeftAShadeTransparentIsOpaque) {
  model::Mesh mesh = mesh_of({V(1, 1), V(8, 1), V(8, 15)});
  mesh.materials[0].opacity = 250.5F / 255;
  EXPECT_EQ(opacities(mesh)[0][0], Opacity::kOpaque);
  mesh.materials[0].opacity = 0.9F;
  EXPECT_NE(opacities(mesh)[0][0], Opacity::kOpaque);
}

// Columns up to 7 are opaque and the others transparent.
bool is_even(const std::array<Eigen::Vector2f, 3>& in_texels, float opacity) {
  model::Mesh mesh = mesh_of(in_texels);
  mesh.materials[0].opacity = opacity;
  return opacities(mesh)[0][0] != Opacity::kVaries;
}

TEST(Even, IsATriangleWhoseTexelsAreAlike) {
  EXPECT_TRUE(is_even({V(1, 1), V(8, 1), V(8, 15)}, 0.5F));
  EXPECT_TRUE(is_even({V(9, 1), V(15, 1), V(15, 15)}, 0.5F));
  EXPECT_FALSE(is_even({V(1, 1), V(12, 1), V(12, 15)}, 0.5F));
  // The material leaves less than 1/100 of the difference.
  EXPECT_TRUE(is_even({V(1, 1), V(12, 1), V(12, 15)}, 0.009F));
  // The texture wraps round within the triangle.
  EXPECT_FALSE(is_even({V(15, 1), V(18, 1), V(18, 3)}, 0.5F));
}

TEST(Even, IsATriangleWithoutATranslucentTexture) {
  model::Mesh mesh = mesh_of({V(1, 1), V(12, 1), V(12, 15)});
  model::Texture texture = *mesh.textures[0];
  texture.has_translucency = false;
  mesh.textures[0] = std::move(texture);
  EXPECT_NE(opacities(mesh)[0][0], Opacity::kVaries);
  mesh.materials[0].texture = -1;
  EXPECT_NE(opacities(mesh)[0][0], Opacity::kVaries);
}

}  // namespace

}  // namespace airtruth::shade
