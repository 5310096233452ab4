// SPDX-License-Identifier: Apache-2.0
#include "picture/render/visibility.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "aircraft/fleet/fleet.h"
#include "aircraft/shapes/shapes.h"
#include "picture/shade/trace.h"

// Compares what the edge functions see with what rays (Embree) meet.
namespace airtruth::render {
namespace {

constexpr int kVisibleSide = 120;
constexpr double kVisibleFocalPx = 1500;

struct VisibleScene {
  lens::Lens lens{
      lens::Pinhole{{kVisibleFocalPx, kVisibleFocalPx}, {kVisibleSide / 2.0, kVisibleSide / 2.0}},
      {kVisibleSide, kVisibleSide}};
  View view;
  Instance instance;

  VisibleScene(const shade::Model& model, const YawPitchRoll& attitude, double range_m) {
    view = {&lens,
            Rigid{cam_from_body().conjugate(), Vector3::Zero()},
            Homography::Identity(),
            kVisibleSide,
            kVisibleSide};
    instance = {&model, {world_from_body(attitude), Vector3(range_m, 0.3, -0.2)}};
  }
  void move() {
    view.shutter = {0.008, 0.016, Readout::kDown};
    view.camera = {{20, 0, 0}, {0.05, 0.1, 0.1}};
    instance.twist = {{40, 60, 5}, {0.1, 0, 0.2}};
  }
};

double size_m(const model::Mesh& mesh) {
  const model::Extents extents = model::extents(mesh);
  return std::max(extents.length_m(), extents.span_m());
}

// What rays through a pixel meet.
struct Met {
  static constexpr int kRays = 256;
  double alpha = 0;
  bool all_opaque = true;
  std::set<std::pair<int, std::uint32_t>> triangles;
};

Met met_by_rays(const VisibleScene& scene, const PlacedInstance& placed, int x, int y) {
  const Shutter& shutter = scene.view.shutter;
  const PixelSamples samples(x, y);
  Met met;
  for (int i = 0; i < Met::kRays; ++i) {
    const auto [u, v, t] = samples.at(i);
    const double dt_s = shutter.middle_s({double(x), double(y)}, kVisibleSide, kVisibleSide) +
                        shutter.exposure_s * (t - 0.5);
    const View then = scene.view.at(dt_s);
    const Rigid body_from_world =
        carried(scene.instance.world_from_body, scene.instance.twist, dt_s).inverse();
    const Vector3 d = (body_from_world.rotation *
                       (then.world_from_cam.rotation * ray_in_cam(then, {x + u, y + v})))
                          .normalized();
    const shade::Model::Impl& model = *placed.placed.model;
    const Vector3 eye = body_from_world * then.world_from_cam.translation;
    const Vector3 start = eye + ((eye - model.centre_in_body).norm() - model.radius_m) * d;
    std::vector<Eigen::Affine3f> poses;
    for (const model::Part& part : model.mesh.parts)
      poses.push_back(model::body_from_part(part, scene.instance.time_s + dt_s));
    const auto hit = shade::nearest_hit(model, poses, {start.cast<float>(), d.cast<float>()}, 0);
    if (!hit) continue;
    met.alpha += 1.0 / Met::kRays;
    met.triangles.emplace(hit->part, hit->triangle);
    met.all_opaque =
        met.all_opaque && model.opaque[static_cast<std::size_t>(hit->part)][hit->triangle] != 0;
  }
  return met;
}

void compare(const std::string& name, double size_px, bool moves) {
  const fleet::Aircraft aircraft = fleet::load_aircraft(name);
  const shade::Model model(aircraft.mesh);
  VisibleScene scene(model, {37, 9, 20}, kVisibleFocalPx * size_m(aircraft.mesh) / size_px);
  if (moves) scene.move();
  const PixelBox patch{0, 0, kVisibleSide, kVisibleSide};
  const PixelRays rays(scene.view, patch);
  std::vector<PlacedInstance> placed = {
      place(scene.instance, scene.view, {}, Box{0, 0, kVisibleSide, kVisibleSide}, rays.span())};
  const RayTriangles triangles(scene.view, patch, rays.span(), placed);
  const SampleCounts counts = counts_for(3, moves);
  const auto visibility = std::make_unique<Visibility>(triangles, placed, rays, counts);
  int pixels = 0;
  int wrong = 0;
  double alpha = 0;
  double strange = 0;
  // Where the aircraft is in the picture, with room for its motion.
  const int half = std::min(kVisibleSide / 2, static_cast<int>(0.75 * size_px) + 3);
  for (int y = kVisibleSide / 2 - half; y < kVisibleSide / 2 + half; ++y) {
    visibility->begin_row(y, 0, kVisibleSide);
    for (int x = kVisibleSide / 2 - half; x < kVisibleSide / 2 + half; ++x) {
      visibility->look(x);
      const Met met = met_by_rays(scene, placed[0], x, y);
      if (!met.all_opaque || (met.alpha == 0 && visibility->alpha() == 0)) continue;
      ++pixels;
      alpha += met.alpha;
      // The rays' own error is about a hundredth.
      if (std::abs(visibility->alpha() - met.alpha) > 1.0 / 32) ++wrong;
      for (const VisibleSurface& surface : visibility->surfaces()) {
        const RayTriangle& of = visibility->triangle(surface.candidate);
        if (!met.triangles.contains({static_cast<int>(of.part), of.in_part}))
          strange += static_cast<double>(surface.weight);
      }
    }
  }
  const auto where = ::testing::Message() << name << " of " << size_px << " px, moves " << moves;
  EXPECT_GT(pixels, 100) << where;
  EXPECT_LE(wrong, pixels / 200) << where;
  EXPECT_LT(strange / alpha, 0.02) << where;
}

TEST(Visibility, TheVisibilityBufferSeesWhatRaysMeet) {
  for (const bool moves : {false, true}) compare("738/738-Ryanair", 40, moves);
}

TEST(Visibility, TheVisibilityBufferSeesWhatRaysMeetAt100Pixels) {
  for (const bool moves : {false, true}) {
    compare("738/738-Ryanair", 100, moves);
    compare("c172/c-fgfs", 100, moves);
  }
}

// The rotors turn by more than a radian while a pixel is exposed, so that each has several spans.
TEST(Visibility, ASpinningPartIsWhereTheReferenceHasIt) {
  const model::Mesh mesh = shapes::multirotor({});
  const shade::Model model(mesh);
  for (const double exposure_s : {0.002, 0.01, 1.0 / 30}) {
    VisibleScene scene(model, {30, 25, 10}, kVisibleFocalPx * size_m(mesh) / 24);
    scene.view.shutter = {exposure_s, 0.004, Readout::kDown};
    Vector3& place = scene.instance.world_from_body.translation;
    place = Vector3(place.x(), 0, 0);
    const Box search{kVisibleSide / 2.0 - 18, kVisibleSide / 2.0 - 18, 36, 36};
    const image::Layer fast = render(scene.view, {}, {scene.instance}, {search}, {.quality = 3});
    const image::Layer reference =
        render(scene.view, {}, {scene.instance}, {search}, {.quality = 5});
    ASSERT_EQ(fast.pixels.size(), reference.pixels.size());
    double worst = 0;
    for (std::size_t i = 0; i < fast.pixels.size(); ++i)
      worst = std::max(worst, std::abs(double(fast.pixels[i].alpha) - reference.pixels[i].alpha));
    EXPECT_LT(worst, 1.0 / 64) << exposure_s;
    EXPECT_GT(reference.areas[0].seen_px, 10);
  }
}

}  // namespace
}  // namespace airtruth::render
