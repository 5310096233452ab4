// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "sequence/setup/moment.h"

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

}  // namespace
}  // namespace airtruth::setup
