// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "aircraft/fleet/fleet.h"
#include "labels/projection/exact_box.h"
#include "picture/render/ray_triangles.h"
#include "picture/render/renderer.h"

namespace airtruth::render {
namespace {

constexpr int kSide = 200;

lens::Lens pinhole(double focal_px) {
  return lens::Lens(lens::Pinhole{{focal_px, focal_px}, {kSide / 2.0, kSide / 2.0}},
                    {kSide, kSide});
}

// The camera looks north from the origin.
View view_through(const lens::Lens& lens) {
  return {&lens,
          Rigid{cam_from_body().conjugate(), Vector3::Zero()},
          Homography::Identity(),
          kSide,
          kSide};
}

void add_quad(model::Mesh& mesh,
              const std::array<Eigen::Vector3f, 4>& corners,
              const model::Material& material) {
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  const Eigen::Vector3f normal =
      (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  for (const auto& corner : corners) {
    mesh.positions.push_back(corner);
    mesh.normals.push_back(normal);
    mesh.uvs.emplace_back(0, 0);
  }
  mesh.materials.push_back(material);
  const auto m = static_cast<std::uint32_t>(mesh.materials.size() - 1);
  if (mesh.parts.empty()) mesh.parts.push_back({.name = "all"});
  mesh.parts[0].triangles.push_back({{base, base + 1, base + 2}, m});
  mesh.parts[0].triangles.push_back({{base, base + 2, base + 3}, m});
}

// A square plate across the line of sight, at a distance of `north` metres. `half` is half its
// side, in metres.
model::Mesh plate(float half, float north, float opacity = 1) {
  model::Mesh mesh;
  model::Material material;
  material.opacity = opacity;
  add_quad(
      mesh,
      {{{north, -half, -half}, {north, half, -half}, {north, half, half}, {north, -half, half}}},
      material);
  return mesh;
}

const Box kAll{0, 0, kSide, kSide};

double alpha_sum(const image::Layer& layer) {
  double sum = 0;
  for (const auto& pixel : layer.pixels) sum += pixel.alpha;
  return sum;
}

shade::Light white() {
  return {{-1, 0, 0}, {0.5f, 0.5f, 0.5f}, {0.3f, 0.3f, 0.3f}, {0.1f, 0.1f, 0.1f}};
}

// A plate of half-side h at distance d spans 2 f h / d pixels. Its edges fall inside pixels, whose
// coverage must be exact.
TEST(Render, APlateCoversWhatProjectionSays) {
  const lens::Lens lens = pinhole(300);
  const shade::Model model(plate(10, 100));
  const image::Layer layer = render(view_through(lens), white(), {{&model, {}, 0}}, {kAll});
  // 60 px, from 70 to 130.
  const double side = 2 * 300.0 * 10 / 100 * 1.0;
  EXPECT_NEAR(alpha_sum(layer), side * side, 0.5);
  // The plate spans 69.7 to 130.3 px.
  const shade::Model odd(plate(10.1f, 100));
  const image::Layer other = render(view_through(lens), white(), {{&odd, {}, 0}}, {kAll});
  EXPECT_NEAR(other.pixels[other.index(69, 100)].alpha, 0.3, 1.0 / 64);
  EXPECT_NEAR(other.pixels[other.index(69, 69)].alpha, 0.09, 1.0 / 64);
  EXPECT_EQ(other.pixels[other.index(68, 100)].alpha, 0);
  EXPECT_EQ(other.pixels[other.index(100, 100)].alpha, 1);
  EXPECT_NEAR(other.depth_m[other.index(100, 100)], 100, 0.1);
}

// A plate of two triangles, turned about the eye. Each pixel would look at one without bounds:
// behind the camera, and beside it where it reaches through the camera's plane.
TEST(RayTriangles, WhatNoRayOfThePatchMeetsIsLeftOut) {
  const lens::Lens lens(lens::BrownConrady{{100, 100}, {100, 100}, {-0.1, 0.01, 0.001, 0.001}},
                        {kSide, kSide});
  const shade::Model model(plate(1, 18));
  View view = view_through(lens);
  const auto count_at = [&](double yaw_deg) {
    const PixelBox patch{0, 0, kSide, kSide};
    const Span span = span_of(view, patch);
    const Instance turned{&model, {world_from_body({yaw_deg, 0, 0}), Vector3::Zero()}};
    std::vector<PlacedInstance> placed = {place(turned, view, white(), kAll, span)};
    return RayTriangles(view, patch, span, placed).all().size();
  };
  for (const double exposure_s : {0.0, 0.02}) {
    view.shutter.exposure_s = exposure_s;
    view.camera.velocity_mps = {20, 0, 0};
    EXPECT_EQ(count_at(0), 2u);
    EXPECT_EQ(count_at(90), 0u);
    EXPECT_EQ(count_at(180), 0u);
  }
}

// A regular polygon of n corners on a circle of radius r, across the line of sight.
model::Mesh disc(int n, double r, float north) {
  model::Mesh mesh;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * kPi * i / n;
    mesh.positions.emplace_back(
        north, static_cast<float>(r * std::cos(a)), static_cast<float>(r * std::sin(a)));
    mesh.normals.emplace_back(-1, 0, 0);
    mesh.uvs.emplace_back(0, 0);
  }
  mesh.materials.emplace_back();
  mesh.parts.push_back({.name = "disc"});
  for (int i = 1; i + 1 < n; ++i)
    mesh.parts[0].triangles.push_back(
        {{0, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i + 1)}, 0});
  return mesh;
}

// The polygon's area is n/2 r^2 sin(2 pi / n); the picture scales it by (f / d)^2.
TEST(Render, ADiscHasItsArea) {
  const lens::Lens lens = pinhole(300);
  for (const double diameter_px : {10.0, 40.0, 90.0}) {
    const double r = diameter_px / 2 * 100 / 300;
    const int n = 90;
    const shade::Model model(disc(n, r, 100));
    const image::Layer layer = render(view_through(lens), white(), {{&model, {}, 0}}, {kAll});
    const double exact = n / 2.0 * r * r * std::sin(2 * kPi / n) * 9;
    EXPECT_NEAR(alpha_sum(layer) / exact, 1, 0.002) << diameter_px;
  }
}

// The share of the unit square at (x, y) on the side of the line where n . p <= c (clipping by
// Sutherland and Hodgman 1974, area by the shoelace formula).
double share_below(double x, double y, const Eigen::Vector2d& normal, double c) {
  const std::array<Eigen::Vector2d, 4> square = {{{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}}};
  std::vector<Eigen::Vector2d> kept;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d& a = square[i];
    const Eigen::Vector2d& b = square[(i + 1) % 4];
    const double da = normal.dot(a) - c;
    const double db = normal.dot(b) - c;
    if (da <= 0) kept.push_back(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) kept.push_back(a + da / (da - db) * (b - a));
  }
  double twice = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const Eigen::Vector2d& a = kept[i];
    const Eigen::Vector2d& b = kept[(i + 1) % kept.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return std::abs(twice) / 2;
}

// The plate is rolled by 5 degrees and far larger than the picture, which only one of its edges
// crosses.
TEST(Render, ASlantedEdgeCoversEachPixelByItsExactShare) {
  const lens::Lens lens = pinhole(300);
  for (const double slant_deg : {5.0, 31.0, 88.0}) {
    const double a = radians(slant_deg);
    const Eigen::Vector2d along(std::cos(a), std::sin(a));  // right, down
    const Eigen::Vector2d across(-std::sin(a), std::cos(a));
    // At 100 m a third of a metre is one pixel.
    const auto corner = [&](double u, double v) {
      const Eigen::Vector2d p = u * along + v * across;
      return Eigen::Vector3f(100, static_cast<float>(p.x()), static_cast<float>(p.y()));
    };
    model::Mesh mesh;
    add_quad(
        mesh, {{corner(-400, -400), corner(400, -400), corner(400, 0.1), corner(-400, 0.1)}}, {});
    const shade::Model model(mesh);
    const image::Layer layer = render(view_through(lens), white(), {{&model, {}, 0}}, {kAll});
    const double c = across.dot(Eigen::Vector2d(100, 100)) + 0.3;  // 0.1 m is 0.3 px
    double worst = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        worst = std::max(
            worst, std::abs(layer.pixels[layer.index(x, y)].alpha - share_below(x, y, across, c)));
    EXPECT_LT(worst, 1.0 / 64) << slant_deg;
    EXPECT_GT(alpha_sum(layer), 0.4 * kSide * kSide);
  }
}

TEST(Render, ASunlitPlateShinesAsLambertSays) {
  const lens::Lens lens = pinhole(300);
  const shade::Model model(plate(10, 100));
  // The sun stands behind the camera and square to the plate. A vertical face sees half sky and
  // half ground.
  const image::Layer layer = render(view_through(lens), white(), {{&model, {}, 0}}, {kAll});
  EXPECT_NEAR(layer.pixels[layer.index(100, 100)].red, 0.5 + 0.2, 1e-4);
  shade::Light aslant = white();
  aslant.to_sun_in_world =
      // The sun stands 60 degrees off the plate's normal.
      Vector3(-1, 0, -std::sqrt(3.0)).normalized();
  const image::Layer dimmer = render(view_through(lens), aslant, {{&model, {}, 0}}, {kAll});
  EXPECT_NEAR(dimmer.pixels[dimmer.index(100, 100)].red, 0.25 + 0.2, 1e-4);
}

TEST(Render, APlateBetweenSunAndPlateCastsAShadow) {
  model::Mesh mesh = plate(10, 100);
  // A smaller plate beside the line of sight blocks the sun, which stands above and behind the
  // camera.
  add_quad(mesh, {{{90, -3, -13}, {90, 3, -13}, {90, 3, -7}, {90, -3, -7}}}, {});
  shade::Light light = white();
  light.to_sun_in_world = Vector3(-1, 0, -1).normalized();
  const lens::Lens lens = pinhole(300);
  const shade::Model model(mesh);
  const image::Layer layer = render(view_through(lens), light, {{&model, {}, 0}}, {kAll});
  EXPECT_NEAR(layer.pixels[layer.index(100, 100)].red, 0.2, 1e-4);  // in the shadow
  EXPECT_NEAR(layer.pixels[layer.index(100, 120)].red,
              0.5 * std::sqrt(0.5) + 0.2,
              1e-4);  // Outside the shadow.
}

TEST(Render, TranslucentOverOpaqueAndInstancesByDepth) {
  const lens::Lens lens = pinhole(300);
  const shade::Model glass(plate(5, 50, 0.25f));
  const shade::Model wall(plate(10, 100));
  const image::Layer layer =
      render(view_through(lens), white(), {{&wall, {}, 0}, {&glass, {}, 0}}, {kAll, kAll});
  const std::size_t middle = layer.index(100, 100);
  EXPECT_NEAR(layer.pixels[middle].alpha, 1, 1e-6);
  EXPECT_NEAR(layer.coverage[0].at(100, 100), 0.75, 1e-5);
  EXPECT_NEAR(layer.coverage[1].at(100, 100), 0.25, 1e-5);
  EXPECT_NEAR(layer.pixels[middle].red, 0.25 * 0.7 + 0.75 * 0.7, 1e-3);
  // The area that the plate alone would cover.
  EXPECT_NEAR(layer.areas[0].alone_px, 3600, 2);
  EXPECT_NEAR(layer.areas[1].alone_px, 0.25 * 3600, 2);
}

TEST(Render, AHomographyMovesTheLayer) {
  const lens::Lens lens = pinhole(300);
  const shade::Model model(plate(4.03f, 100));
  View view = view_through(lens);
  const image::Layer still = render(view, white(), {{&model, {}, 0}}, {kAll});
  Homography frame_from_nominal = Homography::Identity();
  frame_from_nominal(0, 2) = 7;
  frame_from_nominal(1, 2) = -4;
  view.nominal_from_frame = frame_from_nominal.inverse();
  const image::Layer moved = render(view, white(), {{&model, {}, 0}}, {kAll});
  for (int y = 60; y < 140; ++y)
    for (int x = 60; x < 140; ++x)
      ASSERT_NEAR(moved.pixels[moved.index(x + 7, y - 4)].alpha,
                  still.pixels[still.index(x, y)].alpha,
                  1.0 / 64);
}

TEST(Render, WhatTheFrameCutsOffIsCounted) {
  const lens::Lens lens = pinhole(300);
  const shade::Model model(plate(10, 100));
  const Rigid aside{Quaternion::Identity(),
                    // Its middle lies on the right border.
                    Vector3(0, 100.0 / 3, 0)};
  const image::Layer layer =
      render(view_through(lens), white(), {{&model, aside, 0}}, {Box{169, 69, 62, 62}});
  EXPECT_NEAR(layer.areas[0].alone_in_frame_px, 1800, 5);
  EXPECT_NEAR(layer.areas[0].alone_px, 3600, 80);
}

// A plate of 60 px crosses the left (upper) border at 1000 px/s. Row y of 200 is read at 0.1 s
// (y / 200 - 1/2), when the edge of the plate's rows 10 to 70 is at y / 2 - 40: in the mean 20 px
// without. An exposure of 0.1 s takes an edge from 50 px without to 50 px within: 12.5 px.
TEST(Render, WhatTheFrameCutsOffHasTheTimesOfItsRowsAndOfTheExposure) {
  const lens::Lens lens = pinhole(300);
  const shade::Model model(plate(10, 100));
  const auto cut_px = [&](const Shutter& shutter, double middle_px, bool moves_down) {
    View view = view_through(lens);
    view.shutter = shutter;
    const auto aslant = [&](double along, double across) {
      return moves_down ? Vector3(0, across, along) : Vector3(0, along, across);
    };
    Instance passing{&model, {Quaternion::Identity(), aslant((middle_px - 100) / 3, -20)}, 0};
    passing.twist.velocity_mps = aslant(1000.0 / 3, 0);
    const Box search = moves_down ? Box{9, -52, 62, 164} : Box{-52, 9, 164, 62};
    const image::Layer layer = render(view, white(), {passing}, {search});
    EXPECT_NEAR(layer.areas[0].alone_px, 3600, 80);
    return layer.areas[0].alone_px - layer.areas[0].alone_in_frame_px;
  };
  EXPECT_NEAR(cut_px({.readout_s = 0.1, .readout = Readout::kDown}, 40, false), 60 * 20, 80);
  EXPECT_NEAR(cut_px({.readout_s = 0.1, .readout = Readout::kRight}, 40, true), 60 * 20, 80);
  EXPECT_NEAR(cut_px({.exposure_s = 0.1}, 30, false), 60 * 12.5, 80);
}

struct Stand {
  fleet::Aircraft aircraft;
  shade::Model model;
  explicit Stand(const char* name) : aircraft(fleet::load_aircraft(name)), model(aircraft.mesh) {}
};

double worst_against_oracle(const Stand& stand, double size_px, const YawPitchRoll& attitude) {
  const lens::Lens lens = pinhole(2000);
  const View view = view_through(lens);
  const model::Extents extents = model::extents(stand.aircraft.mesh);
  const double range_m = 2000 * std::max(extents.length_m(), extents.span_m()) / size_px;
  const Rigid world_from_body{airtruth::world_from_body(attitude), Vector3(range_m, 0.3, -0.2)};
  const projection::Sight sight{&lens, view.world_from_cam.inverse(), Homography::Identity()};
  const projection::SilhouettePoints silhouette{&stand.aircraft.mesh,
                                                model::silhouette_points(stand.aircraft.mesh)};
  Box box = *projection::exact_box(sight, silhouette, world_from_body, 0).box;
  box = {box.x - 1.5, box.y - 1.5, box.width + 3, box.height + 3};
  const std::vector<Instance> one = {{&stand.model, world_from_body, 0}};
  const image::Layer fast = render(view, white(), one, {box}, {.quality = 3});
  const image::Layer oracle = render(view, white(), one, {box}, {.quality = 5});
  double worst = 0;
  for (std::size_t i = 0; i < fast.pixels.size(); ++i)
    worst = std::max(worst, std::abs(double(fast.pixels[i].alpha) - oracle.pixels[i].alpha));
  return worst;
}

// The aircraft passes through the eye: parts lie in front of and behind the plane of the lens.
TEST(Quality3, HoldsAlphaWhereTheAircraftReachesBehindTheEye) {
  const Stand stand("733/733-AirBaltic");
  const lens::BrownConrady distorted{{12, 12}, {12, 12}, {-0.1, 0.01, 0.001, 0.001}};
  // Its field ends at 94 degrees, within the picture.
  const lens::Fisheye round{{9, 9}, {12, 12}, {-0.04, -0.02}};
  for (const lens::Lens& lens : {lens::pinhole_from_vertical_fov(90, {24, 24}),
                                 lens::Lens(distorted, {24, 24}),
                                 lens::Lens(round, {24, 24}),
                                 lens::fisheye_from_vertical_fov(170, {24, 24})}) {
    const View view = view_through(lens);
    const Box whole{0, 0, 24, 24};
    for (const Vector3& place : {Vector3(0.5, 3, 1), Vector3(-4, 8, 4), Vector3(8, -10, -15)}) {
      const Rigid world_from_body{airtruth::world_from_body({170, -7, 3}), place};
      const std::vector<Instance> one = {{&stand.model, world_from_body, 0}};
      const image::Layer fast = render(view, white(), one, {whole}, {.quality = 3});
      const image::Layer oracle = render(view, white(), one, {whole}, {.quality = 5});
      ASSERT_EQ(fast.pixels.size(), oracle.pixels.size());
      double worst = 0;
      double visible = 0;
      const PixelRays rays(view, {0, 0, 24, 24});
      for (std::size_t i = 0; i < fast.pixels.size(); ++i) {
        // Pixels that the end of a lens's field crosses show nothing.
        if (!rays.at(static_cast<int>(i) % 24, static_cast<int>(i) / 24).known) continue;
        worst = std::max(worst, std::abs(double(fast.pixels[i].alpha) - oracle.pixels[i].alpha));
        visible += oracle.pixels[i].alpha;
      }
      EXPECT_LT(worst, 1.0 / 16) << lens.name() << " at " << place.transpose();
      EXPECT_GT(visible, 5) << lens.name() << " at " << place.transpose();
    }
  }
}

TEST(Quality3, HoldsAlphaWithinOne64thOfTheOracleUpTo50PixelsAndOne40thAbove) {
  for (const char* name : {"738/738-Ryanair", "c172/news"}) {
    const Stand stand(name);
    for (const YawPitchRoll& attitude : {YawPitchRoll{90, 0, 0}, YawPitchRoll{37, 5, 12}}) {
      for (double size_px : {5.0, 20.0, 50.0})
        EXPECT_LT(worst_against_oracle(stand, size_px, attitude), 1.0 / 64)
            << name << " at " << size_px << " px";
    }
    EXPECT_LT(worst_against_oracle(stand, 100, {37, 5, 12}), 1.0 / 40) << name;
  }
}

TEST(Render, OneThreadAndTwoGiveTheSameBytes) {
  const Stand stand("738/738-Ryanair");
  const lens::Lens lens = pinhole(2000);
  const Rigid world_from_body{airtruth::world_from_body({60, 5, 10}), Vector3(1500, 0, 0)};
  std::vector<image::Layer> layers;
  for (std::size_t threads : {1u, 2u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    layers.push_back(render(
        view_through(lens), white(), {{&stand.model, world_from_body, 0}}, {Box{60, 60, 80, 80}}));
  }
  ASSERT_EQ(layers[0].pixels.size(), layers[1].pixels.size());
  for (std::size_t i = 0; i < layers[0].pixels.size(); ++i) {
    ASSERT_EQ(layers[0].pixels[i].alpha, layers[1].pixels[i].alpha);
    ASSERT_EQ(layers[0].pixels[i].red, layers[1].pixels[i].red);
  }
}

}  // namespace
}  // namespace airtruth::render
