// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/moment.h"

#include <cmath>

#include <gtest/gtest.h>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "sequence/setup/world.h"

namespace airtruth::setup {
namespace {

const lens::Lens kLens = lens::pinhole_from_vertical_fov(60, {1280, 960});

// A level camera that looks north.
projection::Sight level_sight() {
  projection::Sight sight;
  sight.lens = &kLens;
  sight.cam_from_world = Rigid{cam_from_body(), Vector3::Zero()};
  return sight;
}

scene::LensMark glint(double along) {
  scene::LensMark mark = scene::usual_mark(scene::DistractorKind::kGlint);
  mark.along = along;
  return mark;
}

TEST(LensMarks, AGlintLiesOnTheLineThroughTheSunAndTheCentre) {
  // Sun 10 degrees to the right and 20 high: its pixel is right of and above the centre.
  const Vector3 to_sun = unit_vector(10, 20);
  const auto at_sun = spot_of(glint(1), level_sight(), to_sun, 0, 1);
  const auto beyond = spot_of(glint(-0.5), level_sight(), to_sun, 0, 1);
  ASSERT_TRUE(at_sun && beyond);
  const double focal_px = 480 / std::tan(radians(30));
  EXPECT_NEAR(at_sun->centre.x(), 640 + focal_px * std::tan(radians(10)), 1e-3);
  EXPECT_NEAR(
      at_sun->centre.y(), 480 - focal_px * std::tan(radians(20)) / std::cos(radians(10)), 1e-3);
  const Pixel centre(640, 480);
  EXPECT_NEAR((beyond->centre - centre + 0.5 * (at_sun->centre - centre)).norm(), 0, 1e-6);
}

TEST(LensMarks, ASunBehindTheCameraHasNoGlint) {
  EXPECT_FALSE(spot_of(glint(-0.5), level_sight(), unit_vector(180, 20), 0, 1));
}

TEST(LensMarks, AMarkIsThereFromItsBeginningToItsEnd) {
  scene::LensMark insect = scene::usual_mark(scene::DistractorKind::kInsect);
  insect.pixel = Pixel(100, 200);
  insect.begin_s = 1;
  insect.end_s = 1.5;
  insect.velocity_px_s = {800, 0};
  EXPECT_FALSE(spot_of(insect, level_sight(), {0, 0, -1}, 0.9, 1));
  EXPECT_FALSE(spot_of(insect, level_sight(), {0, 0, -1}, 1.6, 1));
  const auto spot = spot_of(insect, level_sight(), {0, 0, -1}, 1.25, 1);
  ASSERT_TRUE(spot);
  EXPECT_NEAR(spot->centre.x(), 300, 1e-9);
  EXPECT_NEAR(spot->direction.x(), 1, 1e-12);
}

TEST(LensMarks, DirtHasAShapeOfItsOwnAndKeepsIt) {
  scene::LensMark dirt = scene::usual_mark(scene::DistractorKind::kDirt);
  dirt.id = "dirt-1";
  dirt.pixel = Pixel(100, 200);
  const auto first = spot_of(dirt, level_sight(), {0, 0, -1}, 0, 1);
  const auto later = spot_of(dirt, level_sight(), {0, 0, -1}, 5, 1);
  dirt.pixel = Pixel(400, 200);
  const auto other = spot_of(dirt, level_sight(), {0, 0, -1}, 0, 1);
  EXPECT_EQ(first->cosines, later->cosines);
  EXPECT_NE(first->cosines, other->cosines);
  for (double angle = 0; angle < 6.3; angle += 0.1)
    EXPECT_GT(first->lobe(std::cos(angle), std::sin(angle)), 0.2);
}

// A fisheye whose curve stops rising at 94 degrees, within the picture, and an aircraft that goes
// beyond it. Every pixel whose ray meets the sphere about the aircraft is searched, and few others.
TEST(Moment, SearchesOnlyAboutAnAircraftAcrossTheEndOfALensesField) {
  scene::Scene scene;
  scene.lens.model = lens::ModelKind::kFisheye;
  scene.lens.focal_px = Pixel(90, 90);
  scene.lens.distortion = {-0.04, -0.02, 0, 0};
  scene::Intruder intruder;
  intruder.id = "across";
  intruder.aircraft = "c172/news";
  // From north-east of the camera to south-east of it, 60 m to the east.
  intruder.waypoints_ned_m = {{60, 60, -155}, {-60, 60, -155}};
  intruder.speed_mps = 60;
  scene.intruders = {intruder};
  const World world = load_world(scene, {400, 400}, {});
  double radius_m = 0;
  for (const Eigen::Vector3f& p : world.actors[0].type->silhouette.mesh->positions)
    radius_m = std::max<double>(radius_m, p.norm());
  int across = 0;
  for (double time_s = 0; time_s < 2; time_s += 0.02) {
    const Moment moment = moment_at(world, 0, time_s, {});
    if (!moment.boxes[0].partly_unseen || !moment.boxes[0].box) continue;
    ++across;
    ASSERT_TRUE(moment.search[0]);
    const Box& search = *moment.search[0];
    EXPECT_LT(search.width * search.height, 400 * 400 / 8.0);
    const Vector3 p_in_cam = moment.sight.cam_from_world * moment.states[0]->position_in_world;
    const double half_angle_rad = std::asin(radius_m / p_in_cam.norm());
    for (double y = 0.5; y < 400; ++y)
      for (double x = 0.5; x < 400; ++x) {
        const auto ray = world.lens.ray_from_pixel({x, y});
        if (!ray || std::acos(ray->dot(p_in_cam.normalized())) > half_angle_rad) continue;
        EXPECT_TRUE(x > search.x && x < search.right() && y > search.y && y < search.bottom())
            << x << ", " << y << " at " << time_s << " s";
      }
  }
  EXPECT_GT(across, 5);
}

}  // namespace
}  // namespace airtruth::setup
