// SPDX-License-Identifier: Apache-2.0
#include "picture/backdrop/backdrop.h"

#include <cmath>

#include <gtest/gtest.h>

#include "aircraft/model/texture.h"
#include "foundation/base/error.h"
#include "foundation/geometry/box.h"

namespace airtruth::backdrop {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 64;
const lens::Pinhole kLens{{100, 100}, {48, 32}};
// Light of equal radiance from all directions.
const shade::Light kEven{{0, 0, -1}, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}};

Options software() {
  Options options;
  options.software = true;
  return options;
}

// World axes equal the camera's: x right, y down, z forward. A body keeps its axes.
const Rigid kCamFromWorld{};

model::Mesh empty_mesh() {
  model::Mesh mesh;
  mesh.parts.push_back({"airframe", {}, false, {1, 0, 0}, {0, 0, 0}, 0});
  return mesh;
}

// Adds a rectangle [x0, x1] x [y0, y1] at z that faces the camera.
void add_rectangle(model::Mesh& mesh,
                   const Eigen::Vector4f& bounds,
                   float z,
                   const model::Material& material) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const auto index = static_cast<std::uint32_t>(mesh.materials.size());
  mesh.materials.push_back(material);
  for (int corner = 0; corner < 4; ++corner) {
    const bool right = corner == 1 || corner == 2;
    const bool below = corner >= 2;
    mesh.positions.emplace_back(right ? bounds[1] : bounds[0], below ? bounds[3] : bounds[2], z);
    mesh.normals.emplace_back(0.0f, 0.0f, -1.0f);
    mesh.uvs.emplace_back(right ? 1.0f : 0.0f, below ? 0.0f : 1.0f);
  }
  mesh.parts[0].triangles.push_back({{first, first + 1, first + 2}, index});
  mesh.parts[0].triangles.push_back({{first, first + 2, first + 3}, index});
}

model::Material plain(float r, float g, float b, float opacity = 1) {
  model::Material material;
  material.diffuse = {r, g, b};
  material.opacity = opacity;
  return material;
}

std::array<int, 3> colour(const image::Rgb8& image, int x, int y) {
  const std::uint8_t* p = image.at(x, y);
  return {p[0], p[1], p[2]};
}

const std::array<int, 3> kGreen = {0, 255, 0};

class BackdropTest : public testing::Test {
 protected:
  image::Rgb8 render(const model::Mesh& mesh, const shade::Light& light = kEven) {
    return backdrop_->render(kLens, kCamFromWorld, light, {{&mesh, {}, 0}});
  }
  std::vector<std::array<float, 4>> render_alpha(const model::Mesh& mesh, int supersampling) {
    return backdrop_->render_alpha(kLens, kCamFromWorld, kEven, {{&mesh, {}, 0}}, supersampling);
  }
  static std::size_t at(int x, int y) { return static_cast<std::size_t>(y * kWidth + x); }

  std::unique_ptr<Backdrop> backdrop_ = open_backdrop(kWidth, kHeight, software());
};

TEST_F(BackdropTest, SoftwareIsLlvmpipe) {
  EXPECT_NE(backdrop_->device_name().find("llvmpipe"), std::string::npos)
      << backdrop_->device_name();
}

TEST_F(BackdropTest, WithoutIntrudersAllIsGreen) {
  const image::Rgb8 image = backdrop_->render(kLens, kCamFromWorld, kEven, {});
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) ASSERT_EQ(colour(image, x, y), kGreen);
  }
}

// At 10 m a pixel is 0.1 m: x from -2.8 to -0.8 m is pixel 20 to 40, and y from -2.2 to -1.2 m is
// pixel 10 to 20.
TEST_F(BackdropTest, RectangleCoversItsPixelsAndNoOther) {
  model::Mesh mesh = empty_mesh();
  add_rectangle(mesh, {-2.8f, -0.8f, -2.2f, -1.2f}, 10, plain(1, 0, 0));
  const image::Rgb8 image = render(mesh);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool inside = PixelBox{20, 10, 20, 10}.contains(x, y);
      ASSERT_EQ(colour(image, x, y), inside ? (std::array<int, 3>{255, 0, 0}) : kGreen)
          << x << ' ' << y;
    }
  }
}

TEST_F(BackdropTest, RightIsRightAndDownIsDown) {
  model::Mesh mesh = empty_mesh();
  add_rectangle(mesh, {1.2f, 3.2f, 0.8f, 2.8f}, 10, plain(0, 0, 1));
  const image::Rgb8 image = render(mesh);
  EXPECT_EQ(colour(image, 70, 50), (std::array<int, 3>{0, 0, 255}));
  EXPECT_EQ(colour(image, 26, 50), kGreen);
  EXPECT_EQ(colour(image, 70, 14), kGreen);
}

TEST_F(BackdropTest, PrincipalPointAndFocalLengthsMoveAndStretchIt) {
  model::Mesh mesh = empty_mesh();
  add_rectangle(mesh, {-1, 1, -1, 1}, 10, plain(1, 0, 0));
  const image::Rgb8 image =
      backdrop_->render({{150, 50}, {40, 20}}, kCamFromWorld, kEven, {{&mesh, {}, 0}});
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool inside = PixelBox{25, 15, 30, 10}.contains(x, y);
      ASSERT_EQ(colour(image, x, y) != kGreen, inside) << x << ' ' << y;
    }
  }
}

TEST_F(BackdropTest, InstanceAndCameraPosesAreApplied) {
  model::Mesh mesh = empty_mesh();
  add_rectangle(mesh, {-1, 1, -0.5f, 0.5f}, 0, plain(1, 0, 0));
  // The body is rotated by 90 degrees about the optical axis and stands 10 m in front of a camera
  // at (5, 6, 7).
  const Quaternion quarter(Eigen::AngleAxisd(kPi / 2, Vector3::UnitZ()));
  const Rigid cam_from_world = Rigid{Quaternion::Identity(), {5, 6, 7}}.inverse();
  const image::Rgb8 image =
      backdrop_->render(kLens, cam_from_world, kEven, {{&mesh, {quarter, {5, 6, 17}}, 0}});
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool inside = PixelBox{43, 22, 10, 20}.contains(x, y);
      ASSERT_EQ(colour(image, x, y) != kGreen, inside) << x << ' ' << y;
    }
  }
}

// The rectangle covers three quarters of column 20. With four samples a pixel its colour lies
// between green and red.
TEST_F(BackdropTest, EdgesAreMultisampled) {
  model::Mesh mesh = empty_mesh();
  add_rectangle(mesh, {-2.775f, -0.8f, -2.2f, -1.2f}, 10, plain(1, 0, 0));
  const auto edge = colour(render(mesh), 20, 15);
  EXPECT_NEAR(edge[0], 191, 1);
  EXPECT_NEAR(edge[1], 64, 1);
}

TEST_F(BackdropTest, LightIsLambertPlusTheSkyEncodedAsSrgb) {
  model::Mesh mesh = empty_mesh();
  add_rectangle(mesh, {-2, 2, -2, 2}, 10, plain(0.5f, 0.5f, 0.5f));
  // The plate faces the camera along the world's -z, which points up, so it sees only the sky. The
  // sun stands 60 degrees off its normal.
  const shade::Light light{{std::sin(kPi / 3), 0, -std::cos(kPi / 3)},
                           {0.8f, 0.4f, 0},
                           {0.1f, 0.1f, 0.3f},
                           {0.1f, 0.1f, 0.1f}};
  const auto seen =
      colour(backdrop_->render(kLens, kCamFromWorld, light, {{&mesh, {}, 0}}), 48, 32);
  const auto code = [](double linear) { return 255 * (1.055 * std::pow(linear, 1 / 2.4) - 0.055); };
  EXPECT_NEAR(seen[0], code(0.5 * (0.8 * 0.5 + 0.1)), 1);
  EXPECT_NEAR(seen[1], code(0.5 * (0.4 * 0.5 + 0.1)), 1);
  EXPECT_NEAR(seen[2], code(0.5 * 0.3), 1);
}

TEST_F(BackdropTest, NearerHidesFartherWhateverTheOrder) {
  model::Mesh mesh = empty_mesh();
  add_rectangle(mesh, {-1, 1, -1, 1}, 10, plain(1, 0, 0));
  add_rectangle(mesh, {-1, 1, -1, 1}, 20, plain(0, 0, 1));
  EXPECT_EQ(colour(render(mesh), 48, 32), (std::array<int, 3>{255, 0, 0}));
}

// Three panes: the nearest is red at 1/2, then blue at 1/2, then opaque white. The result is 1/2
// red, 1/4 blue, 1/4 white.
TEST_F(BackdropTest, TranslucentPanesBlendBackToFront) {
  model::Mesh mesh = empty_mesh();
  add_rectangle(mesh, {-1, 1, -1, 1}, 10, plain(1, 0, 0, 0.5f));
  add_rectangle(mesh, {-1.5f, 1.5f, -1.5f, 1.5f}, 11, plain(0, 0, 1, 0.5f));
  add_rectangle(mesh, {-2, 2, -2, 2}, 12, plain(1, 1, 1));
  const auto pixel = render_alpha(mesh, 2)[at(48, 32)];
  EXPECT_NEAR(pixel[0], 0.75, 1e-5);
  EXPECT_NEAR(pixel[1], 0.25, 1e-5);
  EXPECT_NEAR(pixel[2], 0.5, 1e-5);
  EXPECT_NEAR(pixel[3], 1, 1e-5);
}

TEST_F(BackdropTest, PaneOverNothingKeepsItsAlpha) {
  model::Mesh mesh = empty_mesh();
  add_rectangle(mesh, {-1, 1, -1, 1}, 10, plain(1, 0.5f, 0, 0.25f));
  const auto pixel = render_alpha(mesh, 2)[at(48, 32)];
  EXPECT_NEAR(pixel[0], 0.25, 1e-5);
  EXPECT_NEAR(pixel[1], 0.125, 1e-5);
  EXPECT_NEAR(pixel[3], 0.25, 1e-5);
}

// A texture whose left half is opaque blue and whose right half is transparent; its bottom row is v
// = 0.
TEST_F(BackdropTest, TexelsDecideWhatIsSeen) {
  model::Mesh mesh = empty_mesh();
  model::Material material = plain(1, 1, 1);
  material.texture = 0;
  const texture_file::Picture picture{
      4, 2, {255, 0, 255, 255, 255, 0, 255, 255, 0, 0, 0, 0, 0, 0, 0, 0,
             0,   0, 255, 255, 0,   0, 255, 255, 0, 0, 0, 0, 0, 0, 0, 0}};
  mesh.textures.push_back(model::texture_from_picture(picture, false, false));
  add_rectangle(mesh, {-2, 2, -2, 2}, 10, material);
  const image::Rgb8 image = render(mesh);
  EXPECT_EQ(colour(image, 30, 16), (std::array<int, 3>{0, 0, 255}));    // top left: v near 1
  EXPECT_EQ(colour(image, 30, 48), (std::array<int, 3>{255, 0, 255}));  // bottom left: v near 0
  EXPECT_EQ(colour(image, 66, 32), kGreen);
  EXPECT_NEAR(render_alpha(mesh, 4)[at(48, 48)][3], 0.5f, 0.08f);
}

// A disc of radius r at distance d, seen face-on, has pi (f r / d)^2 pixels, less the area that a
// 256-sided polygon lacks.
TEST_F(BackdropTest, AlphaOfADiscSumsToItsArea) {
  model::Mesh mesh = empty_mesh();
  mesh.materials.push_back(plain(1, 1, 1));
  constexpr int kSides = 256;
  mesh.positions.emplace_back(0.0f, 0.0f, 10.0f);
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * kPi * i / kSides;
    mesh.positions.emplace_back(static_cast<float>(1.23 * std::cos(angle)),
                                static_cast<float>(1.23 * std::sin(angle)),
                                10.0f);
  }
  mesh.normals.assign(mesh.positions.size(), Eigen::Vector3f(0, 0, -1));
  for (std::uint32_t i = 0; i < kSides; ++i)
    mesh.parts[0].triangles.push_back({{0, 1 + i, 1 + (i + 1) % kSides}, 0});
  double sum = 0;
  double worst = 0;
  for (const auto& pixel : render_alpha(mesh, 16)) {
    sum += static_cast<double>(pixel[3]);
    worst = std::max(worst, static_cast<double>(pixel[3]));
  }
  const double area = 0.5 * kSides * std::sin(2 * kPi / kSides) * 12.3 * 12.3;
  EXPECT_NEAR(sum, area, 2e-3 * area);
  EXPECT_LE(worst, 1 + 1e-6);
}

TEST_F(BackdropTest, PropellerTurnsAboutItsAxis) {
  model::Mesh mesh = empty_mesh();
  add_rectangle(mesh, {-2, 2, -0.5f, 0.5f}, 10, plain(1, 0, 0));
  model::Part& part = mesh.parts[0];
  part.spins = true;
  part.axis_in_body = {0, 0, 1};
  part.centre_in_body = {0, 0, 10};
  part.revolutions_per_s = 1;
  const image::Rgb8 image = backdrop_->render(kLens, kCamFromWorld, kEven, {{&mesh, {}, 0.25}});
  EXPECT_NE(colour(image, 48, 14), kGreen);
  EXPECT_EQ(colour(image, 30, 32), kGreen);
}

TEST_F(BackdropTest, BehindTheCameraIsNothingAndTwiceTheSameMeshIsTwoInstances) {
  model::Mesh mesh = empty_mesh();
  add_rectangle(mesh, {-0.5f, 0.5f, -0.5f, 0.5f}, 0, plain(1, 0, 0));
  const image::Rgb8 image = backdrop_->render(kLens,
                                              kCamFromWorld,
                                              kEven,
                                              {{&mesh, {Quaternion::Identity(), {-2, 0, 10}}, 0},
                                               {&mesh, {Quaternion::Identity(), {2, 0, 10}}, 0},
                                               {&mesh, {Quaternion::Identity(), {0, 0, -10}}, 0}});
  EXPECT_NE(colour(image, 28, 32), kGreen);
  EXPECT_NE(colour(image, 68, 32), kGreen);
  EXPECT_EQ(colour(image, 48, 32), kGreen);
}

TEST(Backdrop, GpuThatIsNotThereIsAnError) {
  Options options;
  options.gpu = 63;
  EXPECT_THROW(open_backdrop(8, 8, options), Error);
}

}  // namespace
}  // namespace airtruth::backdrop
