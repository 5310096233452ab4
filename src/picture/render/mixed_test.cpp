// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "picture/render/renderer.h"

// A translucent pane in front of an opaque plate, in one aircraft, against areas and colours worked
// out by hand.
namespace airtruth::render {
namespace {

constexpr int kSide = 60;
constexpr double kFocalPx = 300;
constexpr float kOpacity = 0.4f;
const Box kAll{0, 0, kSide, kSide};

// A rectangle across the line of sight, in pixels of the picture.
struct Rectangle {
  double x, y, width, height;
  double area() const { return width * height; }
};

void add(aircraft::Mesh& mesh,
         const Rectangle& at,
         double north_m,
         float opacity,
         std::array<float, 3> diffuse) {
  aircraft::Material material;
  material.opacity = opacity;
  material.diffuse = diffuse;
  mesh.materials.push_back(material);
  const auto m = static_cast<std::uint32_t>(mesh.materials.size() - 1);
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  const auto corner = [&](double x, double y) {
    const double metres = north_m / kFocalPx;
    mesh.positions.push_back(
        Eigen::Vector3d(north_m, (x - kSide / 2.0) * metres, (y - kSide / 2.0) * metres)
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
const Light kLight{{-1, 0, 0}, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}};
constexpr std::array<float, 3> kPlateColour = {0.6f, 0.1f, 0.2f};
constexpr std::array<float, 3> kPaneColour = {0.1f, 0.5f, 0.3f};
constexpr double kPlateM = 100;
constexpr double kPaneM = 90;

class PaneBeforePlate : public testing::TestWithParam<int> {};

TEST_P(PaneBeforePlate, HasTheAlphaTheColourAndTheDistanceOfBoth) {
  const Rectangle plate{20.3, 18.7, 14.6, 21.9};
  const Rectangle pane{28.15, 24.4, 17.2, 9.35};
  const double both = (plate.x + plate.width - pane.x) * pane.height;
  aircraft::Mesh mesh;
  add(mesh, plate, kPlateM, 1, kPlateColour);
  add(mesh, pane, kPaneM, kOpacity, kPaneColour);
  const Model model(mesh);
  const lens::Lens lens(lens::Pinhole{{kFocalPx, kFocalPx}, {kSide / 2.0, kSide / 2.0}},
                        {kSide, kSide});
  View view{&lens,
            Rigid{cam_from_body().conjugate(), Vector3::Zero()},
            Homography::Identity(),
            kSide,
            kSide};
  // A long exposure of a scene at rest is the scene at an instant, but takes the other code.
  if (GetParam() > 0) view.shutter = {0.01, 0.01, Readout::kDown};
  const Instance instance{&model, {Quaternion::Identity(), Vector3::Zero()}};
  const image::Layer layer = render(view, kLight, {instance}, {kAll});
  double alpha = 0;
  std::array<double, 3> rgb{};
  for (const image::LayerPixel& pixel : layer.pixels) {
    alpha += static_cast<double>(pixel.alpha);
    rgb[0] += static_cast<double>(pixel.red);
    rgb[1] += static_cast<double>(pixel.green);
    rgb[2] += static_cast<double>(pixel.blue);
  }
  const auto opacity = static_cast<double>(kOpacity);
  EXPECT_NEAR(alpha, plate.area() + opacity * (pane.area() - both), 0.2);
  EXPECT_NEAR(layer.area_seen_px[0], alpha, 1e-3);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(rgb[c],
                static_cast<double>(kPlateColour[c]) * (plate.area() - opacity * both) +
                    static_cast<double>(kPaneColour[c]) * opacity * pane.area(),
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

INSTANTIATE_TEST_SUITE_P(AtAnInstantAndDuringAnExposure, PaneBeforePlate, testing::Values(0, 1));

}  // namespace
}  // namespace airtruth::render
