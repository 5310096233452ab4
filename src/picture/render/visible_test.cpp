// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "aircraft/fleet/fleet.h"
#include "picture/render/packets.h"
#include "picture/render/pixel_rays.h"
#include "picture/render/silhouette.h"

// Compares the surfaces that the depth buffer finds with those that rays (Embree) meet, at random
// poses.
namespace airtruth::render {
namespace {

constexpr int kFrameSide = 120;
const Box kWhole{0, 0, kFrameSide, kFrameSide};

struct Scene {
  lens::Lens lens;
  View view;
  Instance instance;
};

Scene scene_of(
    const Model& model, double size_m, double size_px, bool moves, std::mt19937& random) {
  std::uniform_real_distribution<double> angle(-180, 180);
  const double focal_px = 1500;
  Scene scene{lens::Lens(lens::Pinhole{{focal_px, focal_px}, {kFrameSide / 2.0, kFrameSide / 2.0}},
                         {kFrameSide, kFrameSide}),
              {},
              {}};
  const Vector3 place(focal_px * size_m / size_px, 0.3, -0.2);
  scene.instance = {
      &model, {world_from_body({angle(random), angle(random) / 4, angle(random) / 2}), place}};
  scene.view = {nullptr,
                Rigid{cam_from_body().conjugate(), Vector3::Zero()},
                Homography::Identity(),
                kFrameSide,
                kFrameSide};
  if (!moves) return scene;
  scene.view.shutter = {0.008, 0.016, Readout::kDown};
  scene.view.camera = {{20, 0, 0}, {0.05, 0.1, 0.1}};
  scene.instance.twist = {{40, 60, 5}, {0.1, 0, 0.2}};
  return scene;
}

// Distances of one pixel: from the depth buffer and by rays through the same samples, with the
// share of the samples in which anything is seen.
struct Compared {
  double seen = 0;
  double hit = 0;
  double distance_m = 0;
  double ray_distance_m = 0;
  // Share of the samples whose triangle a ray does not see in any sample of the pixel.
  double strange = 0;
};

Vector3 point_of(const TracedIntruder& actor, const Hit& hit) {
  const Facet& facet = actor.placed.facet(hit);
  const Eigen::Vector3f p =
      (1 - hit.u - hit.v) * facet.corner[0] + hit.u * facet.corner[1] + hit.v * facet.corner[2];
  return (actor.placed.body_from_part[static_cast<std::size_t>(hit.part)] * p).cast<double>();
}

Compared compare(
    const TracedIntruder& actor, const RayGrid& grid, const Silhouette& silhouette, int x, int y) {
  const SampleCounts counts = counts_for(3, 100);
  const int samples = counts.visible_side * counts.visible_side;
  Compared result;
  Visible visible;
  result.seen = double(silhouette.see(x, y, counts, visible)) / samples;
  const PixelEye eye(actor, grid, x, y);
  const PixelRays rays(actor, grid, x, y);
  std::map<std::pair<int, std::uint32_t>, int> met;
  for (int i = 0; i < samples; ++i) {
    std::array<double, 1> dt_s;
    const std::array<BodyRay, 1> ray = {rays.ray(i, dt_s[0])};
    std::array<std::optional<Hit>, 1> hit;
    nearest_hits(actor.placed, ray, dt_s, hit);
    if (!hit[0]) continue;
    result.hit += 1.0 / samples;
    result.ray_distance_m += actor.start_m + static_cast<double>(hit[0]->t);
    ++met[{hit[0]->part, hit[0]->triangle}];
  }
  result.ray_distance_m /= std::max(1.0, samples * result.hit);
  double of = 0;
  for (const Spot& spot : visible.spots) {
    const double weight = static_cast<double>(spot.samples);
    result.distance_m += weight * (point_of(actor, spot.hit) - eye.at(spot.time)).norm();
    of += weight;
    if (!met.contains({spot.hit.part, spot.hit.triangle})) result.strange += weight / samples;
  }
  if (of > 0) result.distance_m /= of;
  return result;
}

void compare_all(const char* name, double size_px, bool moves) {
  const aircraft::Aircraft aircraft = aircraft::load_aircraft(name);
  const Model model(aircraft.mesh);
  const aircraft::Extents extents = aircraft::extents(aircraft.mesh);
  std::mt19937 random(7);
  int pixels = 0;
  int wrong = 0;
  double strange = 0;
  for (int pose = 0; pose < 2; ++pose) {
    Scene scene =
        scene_of(model, std::max(extents.length_m(), extents.span_m()), size_px, moves, random);
    scene.view.lens = &scene.lens;
    const PixelBox patch{0, 0, kFrameSide, kFrameSide};
    const RayGrid grid(scene.view, patch);
    const TracedIntruder actor = place(scene.instance, scene.view, {}, kWhole, grid.span());
    const Silhouette silhouette(actor, scene.view, patch, grid, true);
    for (int y = 0; y < kFrameSide; ++y)
      for (int x = 0; x < kFrameSide; ++x) {
        if (silhouette.touch(x, y) != Silhouette::Touch::kOpaque) continue;
        const Compared here = compare(actor, grid, silhouette, x, y);
        if (here.seen == 0 && here.hit == 0) continue;
        ++pixels;
        strange += here.strange;
        // One sample of 64 may be on the other side of an edge. It may see another wing, so that
        // only pixels without an outline have a bound for their distance.
        if (std::abs(here.seen - here.hit) > 1.5 / 64) ++wrong;
        if (here.seen == 1 && here.hit == 1 &&
            std::abs(here.distance_m - here.ray_distance_m) > 0.4)
          ++wrong;
      }
  }
  const auto where = ::testing::Message() << name << " of " << size_px << " px, moves " << moves;
  EXPECT_GT(pixels, 150) << where;
  EXPECT_LE(wrong, pixels / 200) << where;
  EXPECT_LT(strange / pixels, 0.004) << where;
}

TEST(Visible, TheDepthBufferSeesWhatRaysMeet) {
  for (const bool moves : {false, true}) {
    compare_all("738/738-Ryanair", 40, moves);
    compare_all("738/738-Ryanair", 100, moves);
    compare_all("c172/c-fgfs", 100, moves);
  }
}

}  // namespace
}  // namespace airtruth::render
