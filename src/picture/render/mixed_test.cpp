// SPDX-License-Identifier: Apache-2.0
#include <array>

#include <gtest/gtest.h>

#include "aircraft/model/texture.h"
#include "picture/render/renderer.h"

// A translucent pane in front of an opaque plate, in one aircraft, against areas and colours worked
// out by hand.
namespace airtruth::render {
namespace {

constexpr int kMixedSide = 60;
constexpr double kMixedFocalPx = 300;
constexpr float kOpacity = 0.4f;
const Box kWholeMixed{0, 0, kMixedSide, kMixedSide};

// A rectangle across the line of sight, in pixels of the picture.
struct Rectangle {
  double x, y, width, height;
  constexpr double area() const { return width * height; }
};

void add(model::Mesh& mesh,
         const Rectangle& at,
         double north_m,
         float opacity,
         std::array<float, 3> diffuse) {
  model::Material material;
  material.opacity = opacity;
  material.diffuse = diffuse;
  mesh.materials.push_back(material);
  const auto m = static_cast<std::uint32_t>(mesh.materials.size() - 1);
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  const auto corner = [&](double x, double y) {
    const double metres = north_m / kMixedFocalPx;
    mesh.positions.push_back(
        Eigen::Vector3d(north_m, (x - kMixedSide / 2.0) * metres, (y - kMixedSide / 2.0) * metres)
            .cast<float>());
    mesh.normals.emplace_back(-1, 0, 0);
    mesh.uvs.emplace_back(0, 0);
  };
  corner(at.x, at.y);
  corner(at.x + at.width, at.y);
  corner(at.x + at.width, at.y + at.height);
  corner(at.x, at.y + at.height);
  if (mesh.parts.empty()) mesh.parts.push_back({.name = "all"});
  mesh.parts[0].triangles.push_back({{base, base + 1, base + 2}, m});
  mesh.parts[0].triangles.push_back({{base, base + 2, base + 3}, m});
}

// The same light from everywhere and no sun, so that a surface has its own colour.
const shade::Light kLight{{-1, 0, 0}, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}};
constexpr std::array<float, 3> kPlateColour = {0.6f, 0.1f, 0.2f};
constexpr std::array<float, 3> kPaneColour = {0.1f, 0.5f, 0.3f};
constexpr double kPlateM = 100;
constexpr double kPaneM = 90;
// Each crosses pixels, and they overlap at one side of the plate.
constexpr Rectangle kPlate{20.3, 18.7, 14.6, 21.9};
constexpr Rectangle kPane{28.15, 24.4, 17.2, 9.35};
constexpr double kBothArea = (kPlate.x + kPlate.width - kPane.x) * kPane.height;

const lens::Lens& pinhole() {
  static const lens::Lens lens(
      lens::Pinhole{{kMixedFocalPx, kMixedFocalPx}, {kMixedSide / 2.0, kMixedSide / 2.0}},
      {kMixedSide, kMixedSide});
  return lens;
}

// exposes: a long exposure of a scene at rest, which is the scene at an instant, but takes the
// other code.
image::Layer layer_of(const model::Mesh& mesh, bool exposes) {
  const shade::Model model(mesh);
  View view{&pinhole(),
            Rigid{cam_from_body().conjugate(), Vector3::Zero()},
            Homography::Identity(),
            kMixedSide,
            kMixedSide};
  if (exposes) view.shutter = {0.01, 0.01, Readout::kDown};
  const Instance instance{&model, {Quaternion::Identity(), Vector3::Zero()}};
  return render(view, kLight, {instance}, {kWholeMixed});
}

double total_alpha(const image::Layer& layer) {
  double alpha = 0;
  for (const image::LayerPixel& pixel : layer.pixels) alpha += static_cast<double>(pixel.alpha);
  return alpha;
}

class Panes : public testing::TestWithParam<int> {};

TEST_P(Panes, BeforeAPlateHaveTheAlphaTheColourAndTheDistanceOfBoth) {
  model::Mesh mesh;
  add(mesh, kPlate, kPlateM, 1, kPlateColour);
  add(mesh, kPane, kPaneM, kOpacity, kPaneColour);
  const image::Layer layer = layer_of(mesh, GetParam() > 0);
  const double alpha = total_alpha(layer);
  std::array<double, 3> rgb{};
  for (const image::LayerPixel& pixel : layer.pixels) {
    rgb[0] += static_cast<double>(pixel.red);
    rgb[1] += static_cast<double>(pixel.green);
    rgb[2] += static_cast<double>(pixel.blue);
  }
  const auto opacity = static_cast<double>(kOpacity);
  EXPECT_NEAR(alpha, kPlate.area() + opacity * (kPane.area() - kBothArea), 0.2);
  EXPECT_NEAR(layer.areas[0].seen_px, alpha, 1e-3);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(rgb[c],
                static_cast<double>(kPlateColour[c]) * (kPlate.area() - opacity * kBothArea) +
                    static_cast<double>(kPaneColour[c]) * opacity * kPane.area(),
                0.5)
        << c;
  const auto at = [&](int x, int y) { return layer.index(x, y); };
  const std::size_t through_pane = at(31, 29);
  EXPECT_FLOAT_EQ(layer.pixels[through_pane].alpha, 1);
  EXPECT_NEAR(static_cast<double>(layer.pixels[through_pane].green),
              opacity * 0.5 + (1 - opacity) * 0.1,
              1e-3);
  EXPECT_NEAR(static_cast<double>(layer.depth_m[through_pane]),
              opacity * kPaneM + (1 - opacity) * kPlateM,
              0.05);
  EXPECT_NEAR(static_cast<double>(layer.pixels[at(40, 29)].alpha), opacity, 1e-3);
  EXPECT_NEAR(static_cast<double>(layer.depth_m[at(40, 29)]), kPaneM, 0.15);
}

// Before nothing but the sky; the samples of a pixel are covered by one of them, or by both.
TEST_P(Panes, OfTwoThatOverlapEachStopsItsShareOfWhatTheOtherLeaves) {
  model::Mesh mesh;
  add(mesh, kPlate, kPlateM, 0.7F, kPlateColour);
  add(mesh, kPane, kPaneM, 0.4F, kPaneColour);
  const image::Layer layer = layer_of(mesh, GetParam() > 0);
  EXPECT_NEAR(
      total_alpha(layer), 0.7 * kPlate.area() + 0.4 * kPane.area() - 0.7 * 0.4 * kBothArea, 0.2);
  const std::size_t in_both = layer.index(31, 29);
  EXPECT_NEAR(static_cast<double>(layer.pixels[in_both].alpha), 1 - 0.3 * 0.6, 1e-5);
  EXPECT_NEAR(static_cast<double>(layer.depth_m[in_both]),
              (0.4 * kPaneM + 0.6 * 0.7 * kPlateM) / (1 - 0.3 * 0.6),
              0.05);
}

// Its texture is opaque on one side of a line across a pixel, and transparent on the other.
TEST_P(Panes, OfDifferentOpacityInAPixelHaveTheirMean) {
  constexpr int kTexels = 64;
  const Rectangle pane{10, 10, 20, 30};
  model::Mesh mesh;
  add(mesh, pane, kPaneM, 1, kPaneColour);
  texture_file::Picture picture{kTexels, kTexels, {}};
  for (int i = 0; i < kTexels * kTexels; ++i)
    picture.rgba.insert(picture.rgba.end(), 4, i % kTexels < 24 ? 255 : 0);
  mesh.textures.push_back(model::texture_from_picture(picture, false, false));
  mesh.materials[0].texture = 0;
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const image::Layer layer = layer_of(mesh, GetParam() > 0);
  EXPECT_NEAR(total_alpha(layer), pane.area() * 24 / kTexels, 1);
  // The line is at x = 10 + 20 * 24 / 64 = 17.5.
  EXPECT_NEAR(static_cast<double>(layer.pixels[layer.index(17, 20)].alpha), 0.5, 0.03);
}

INSTANTIATE_TEST_SUITE_P(AtAnInstantAndDuringAnExposure, Panes, testing::Values(0, 1));

}  // namespace
}  // namespace airtruth::render
