// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "picture/render/renderer.h"

// Scenes whose light has a known answer.
namespace airtruth::render {
namespace {

constexpr int kStageSide = 120;
const Box kWhole{0, 0, kStageSide, kStageSide};
// Share that a clear coat mirrors along the normal.
constexpr float kCoat = 0.04f;

struct Stage {
  lens::Lens lens{lens::Pinhole{{300, 300}, {kStageSide / 2.0, kStageSide / 2.0}},
                  {kStageSide, kStageSide}};
  View view{&lens,
            // The camera looks north from the origin.
            Rigid{cam_from_body().conjugate(), Vector3::Zero()},
            Homography::Identity(),
            kStageSide,
            kStageSide};

  image::LayerPixel middle(const model::Mesh& mesh,
                           const shade::Light& light,
                           Rigid body = {}) const {
    const image::Layer layer = whole(mesh, light, body);
    return layer.pixels[layer.index(kStageSide / 2, kStageSide / 2)];
  }
  image::Layer whole(const model::Mesh& mesh, const shade::Light& light, Rigid body = {}) const {
    const shade::Model model(mesh);
    return render(view, light, {{&model, body, 0}}, {kWhole});
  }
};

void add_triangles(model::Mesh& mesh, const std::vector<std::array<Eigen::Vector3f, 3>>& all) {
  if (mesh.parts.empty()) mesh.parts.push_back({.name = "all"});
  if (mesh.materials.empty()) mesh.materials.emplace_back();
  for (const auto& corners : all) {
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    const Eigen::Vector3f normal =
        (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
    for (const auto& corner : corners) {
      mesh.positions.push_back(corner);
      mesh.normals.push_back(normal);
      mesh.uvs.emplace_back(0, 0);
    }
    mesh.parts[0].triangles.push_back({{base, base + 1, base + 2}, 0});
  }
}

// A square about the origin across x, with half-side h and its front to the south.
model::Mesh plate(float h) {
  model::Mesh mesh;
  add_triangles(
      mesh,
      {{Eigen::Vector3f(0, -h, -h), Eigen::Vector3f(0, h, h), Eigen::Vector3f(0, h, -h)},
       {Eigen::Vector3f(0, -h, -h), Eigen::Vector3f(0, -h, h), Eigen::Vector3f(0, h, h)}});
  return mesh;
}

// A sphere by longitude and latitude, with exact normals.
model::Mesh sphere(float radius) {
  model::Mesh mesh;
  constexpr int kSteps = 48;
  const auto at = [&](int i, int k) {
    const auto u = static_cast<float>(2 * kPi * i / (2 * kSteps));
    const auto v = static_cast<float>(kPi * k / kSteps);
    return Eigen::Vector3f(radius * std::sin(v) * std::cos(u),
                           radius * std::sin(v) * std::sin(u),
                           radius * std::cos(v));
  };
  for (int i = 0; i < 2 * kSteps; ++i)
    for (int k = 0; k < kSteps; ++k)
      add_triangles(
          mesh,
          {{at(i, k), at(i, k + 1), at(i + 1, k + 1)}, {at(i, k), at(i + 1, k + 1), at(i + 1, k)}});
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    mesh.normals[i] = mesh.positions[i].normalized();
  return mesh;
}

Rigid at_distance(double north_m, double pitch_deg = 0) {
  return {world_from_body({0, pitch_deg, 0}), Vector3(north_m, 0, 0)};
}

shade::Light only(const shade::Environment& surroundings) {
  shade::Light light;
  light.sun = {0, 0, 0};
  light.surroundings = surroundings;
  return light;
}

shade::Environment even(float radiance) {
  return shade::Environment::of([=](const Vector3&) {
    return image::Rgb{radiance, radiance, radiance};
  });
}

// A white sphere in a uniform white environment: each reflected ray finds the radiance that is also
// behind the sphere.
TEST(LightAround, AWhiteSphereInAFurnaceIsInvisible) {
  const Stage stage;
  const image::Layer layer = stage.whole(sphere(4), only(even(1)), at_distance(100));
  double covered = 0;
  for (const image::LayerPixel& pixel : layer.pixels) {
    EXPECT_NEAR(pixel.red, pixel.alpha, 0.02);
    covered += static_cast<double>(pixel.alpha);
  }
  EXPECT_GT(covered, 400);
}

// A black coated sphere mirrors by Schlick's formula: 0.04 in its middle and nearly everything at
// its rim.
TEST(LightAround, ABlackSphereHasABrightRim) {
  model::Mesh black = sphere(4);
  black.materials[0].diffuse = {0, 0, 0};
  const Stage stage;
  EXPECT_NEAR(stage.middle(black, only(even(1)), at_distance(100)).green, kCoat, 0.002);
  const image::Layer layer = stage.whole(black, only(even(1)), at_distance(100));
  const image::LayerPixel rim =
      layer.pixels[layer.index(kStageSide / 2 + 9, kStageSide / 2)];  // The rim is at 12 px.
  const double cosine = std::sqrt(1 - std::pow(9.5 / 12, 2));
  EXPECT_NEAR(rim.green / rim.alpha, 0.04 + 0.96 * std::pow(1 - cosine, 5), 0.02);
}

// The only light comes from below, with a radiance of 1. A plate that faces down receives all of
// it, a vertical one half, one that faces up nothing; one tilted by t from the vertical receives (1
// + sin t) / 2.
TEST(LightAround, APlateOverBrightGroundGetsWhatItFaces) {
  const shade::Environment below = shade::Environment::of([](const Vector3& d) {
    return d.z() > 0 ? image::Rgb{1, 1, 1} : image::Rgb{0, 0, 0};
  });
  const Stage stage;
  for (const double pitch_deg : {0.0, 30.0, 60.0, -30.0}) {
    // A raised nose turns the side that faces south towards the ground.
    const double expected = (1 + std::sin(radians(pitch_deg))) / 2;
    const float got = stage.middle(plate(10), only(below), at_distance(100, pitch_deg)).blue;
    EXPECT_NEAR(static_cast<double>(got), expected, 0.06) << pitch_deg;
  }
}

// The sun stands 60 degrees aside, so that its glint misses the camera.
TEST(LightAround, APlateInTheSunGivesItsLightBack) {
  const Stage stage;
  shade::Light light = only(even(0));
  light.to_sun_in_world = {-0.5, 0, -std::sqrt(0.75)};
  light.sun = {0.8f, 0.7f, 0.6f};
  const image::LayerPixel pixel = stage.middle(plate(10), light, at_distance(100));
  EXPECT_NEAR(pixel.red, (1 - kCoat) * 0.5f * 0.8f, 0.002);
  EXPECT_NEAR(pixel.blue, (1 - kCoat) * 0.5f * 0.6f, 0.002);
}

// A ball that mirrors all light reflects the sun's evenly into all directions, so that its disc has
// a mean radiance of the sun's irradiance over 4 pi. A clear coat reflects the share that it
// mirrors at half the angle between sun and camera (Schlick 1994), where the disc shows the sun.
TEST(LightAround, ABlackSphereMirrorsTheSun) {
  model::Mesh black = sphere(4);
  black.materials[0].diffuse = {0, 0, 0};
  const Stage stage;
  shade::Light light = only(even(0));
  light.sun = {1, 1, 1};
  for (const double between_deg : {30.0, 90.0, 120.0}) {
    const double a = radians(between_deg);
    light.to_sun_in_world = {-std::cos(a), 0, -std::sin(a)};
    const image::Layer layer = stage.whole(black, light, at_distance(100));
    double sum = 0;
    double covered = 0;
    for (const image::LayerPixel& pixel : layer.pixels) {
      sum += static_cast<double>(pixel.red);
      covered += static_cast<double>(pixel.alpha);
    }
    const double share = 0.04 + 0.96 * std::pow(1 - std::cos(a / 2), 5);
    EXPECT_NEAR(sum / covered / (share / 4), 1, 0.12) << between_deg;
  }
}

// A small plate at the foot of a very long wall sees half of the light. The plate hardly shades the
// wall, which reflects like light paint: 0.6 of the light that it hides.
TEST(LightAround, AWallHidesHalfOfTheLight) {
  model::Mesh mesh = plate(0.5f);
  add_triangles(mesh,
                {{Eigen::Vector3f(0, -50, 0.5f),
                  Eigen::Vector3f(-50, -50, 0.5f),
                  Eigen::Vector3f(-50, 50, 0.5f)},
                 {Eigen::Vector3f(0, -50, 0.5f),
                  Eigen::Vector3f(-50, 50, 0.5f),
                  Eigen::Vector3f(0, 50, 0.5f)}});
  const Stage stage;
  const image::LayerPixel alone = stage.middle(plate(0.5f), only(even(1)), at_distance(40));
  const image::LayerPixel pixel = stage.middle(mesh, only(even(1)), at_distance(40));
  EXPECT_NEAR(alone.red, 1, 0.01);
  EXPECT_NEAR(pixel.red, 0.5 + 0.5 * 0.6, 0.03);
}

// The sun shines along a plate and squarely on a wall at its edge. The wall fills half of the
// plate's view, so the plate receives half of the wall's 0.6. The renderer finds it to a sixteenth
// of all directions.
TEST(LightAround, ASunlitWallLightsAPlateInShadow) {
  model::Mesh mesh = plate(0.5f);
  add_triangles(mesh,
                {{Eigen::Vector3f(0, -50, 0.5f),
                  Eigen::Vector3f(-50, -50, 0.5f),
                  Eigen::Vector3f(-50, 50, 0.5f)},
                 {Eigen::Vector3f(0, -50, 0.5f),
                  Eigen::Vector3f(-50, 50, 0.5f),
                  Eigen::Vector3f(0, 50, 0.5f)}});
  const Stage stage;
  shade::Light light = only(even(0));
  light.to_sun_in_world = Vector3(1e-3, 0, -1).normalized();
  light.sun = {1, 1, 1};
  EXPECT_EQ(stage.middle(plate(0.5f), light, at_distance(40)).red, 0);
  const image::LayerPixel pixel = stage.middle(mesh, light, at_distance(40));
  EXPECT_NEAR(pixel.red, (1 - kCoat) * 0.5f * 0.6f, 0.6f / 16);
}

// Bare metal of albedo 1 mirrors all light, so it is invisible in a uniform environment as well.
TEST(LightAround, AWhiteMetalSphereInAFurnaceIsInvisible) {
  model::Mesh metal = sphere(4);
  metal.materials[0].finish = model::Finish::kMetal;
  const Stage stage;
  const image::Layer layer = stage.whole(metal, only(even(1)), at_distance(100));
  for (const image::LayerPixel& pixel : layer.pixels) EXPECT_NEAR(pixel.red, pixel.alpha, 0.001);
}

// It also reflects the sun in its own colour, wherever the sun stands.
TEST(LightAround, AMetalSphereMirrorsTheSunInItsColour) {
  model::Mesh copper = sphere(4);
  copper.materials[0].finish = model::Finish::kMetal;
  copper.materials[0].diffuse = {0.9f, 0.6f, 0.4f};
  const Stage stage;
  shade::Light light = only(even(0));
  light.sun = {1, 1, 1};
  light.to_sun_in_world = {-std::sqrt(0.75), 0, -0.5};
  const image::Layer layer = stage.whole(copper, light, at_distance(100));
  double red = 0, blue = 0, covered = 0;
  for (const image::LayerPixel& pixel : layer.pixels) {
    red += static_cast<double>(pixel.red);
    blue += static_cast<double>(pixel.blue);
    covered += static_cast<double>(pixel.alpha);
  }
  EXPECT_NEAR(red / covered, 0.9 / 4, 0.03);
  EXPECT_NEAR(blue / red, 0.4 / 0.9, 0.02);
}

// A pane that hides a quarter of its background mirrors as much as an opaque one. The share that it
// hides shows a dark interior.
TEST(LightAround, AClearPaneMirrorsAsAnOpaqueOneDoes) {
  const Stage stage;
  for (const float opacity : {0.25f, 1.0f}) {
    model::Mesh pane = plate(10);
    pane.materials[0].finish = model::Finish::kGlass;
    pane.materials[0].opacity = opacity;
    const image::LayerPixel pixel = stage.middle(pane, only(even(1)), at_distance(100));
    EXPECT_NEAR(pixel.alpha, opacity, 1e-4);
    EXPECT_NEAR(pixel.red, kCoat + (1 - kCoat) * opacity * 0.05f, 0.003) << opacity;
  }
}

// The discs that represent turning blades are mat.
TEST(LightAround, AMatPlateMirrorsNothing) {
  model::Mesh mat = plate(10);
  mat.materials[0].finish = model::Finish::kMat;
  mat.materials[0].diffuse = {0, 0, 0};
  const Stage stage;
  EXPECT_EQ(stage.middle(mat, only(even(1)), at_distance(100)).red, 0);
}

// Light of one direction on a Lambert surface: order 2 approximates the cosine within 9 % of its
// maximum (Ramamoorthi and Hanrahan 2001).
TEST(Environment, IrradianceOfOneDirectionIsNearlyTheCosine) {
  const Vector3 from = Vector3(1, 2, -3).normalized();
  constexpr double kHalfDeg = 8;
  const double solid_sr = 2 * kPi * (1 - std::cos(radians(kHalfDeg)));
  const auto radiance = static_cast<float>(kPi / solid_sr);
  const shade::Environment light = shade::Environment::of([&](const Vector3& d) {
    return d.dot(from) > std::cos(radians(kHalfDeg)) ? image::Rgb{radiance, 0, 0}
                                                     : image::Rgb{0, 0, 0};
  });
  for (const Vector3& n :
       {from, Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, -1), Vector3(0, 0, 1)}) {
    EXPECT_NEAR(static_cast<double>(light.irradiance_over_pi(n.cast<float>())[0]),
                std::max(0.0, n.dot(from)),
                0.09);
    EXPECT_EQ(light.irradiance_over_pi(n.cast<float>())[1], 0);
  }
}

}  // namespace
}  // namespace airtruth::render
