// SPDX-License-Identifier: Apache-2.0
#include "comparison/match/pose.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "aircraft/fleet/fleet.h"
#include "aircraft/model/mesh.h"
#include "comparison/appearance/segment.h"
#include "foundation/image/colour.h"
#include "labels/projection/exact_box.h"
#include "picture/composite/matte.h"
#include "picture/render/renderer.h"

namespace airtruth::match {
namespace {

// The aircraft in a plain sky, straight ahead of a camera that looks north, as large as `size_px`.
cv::Mat mask_in_the_sky(const model::Mesh& mesh, const YawPitchRoll& attitude, double size_px) {
  constexpr int kWidth = 200, kHeight = 160;
  const model::Extents extents = model::extents(mesh);
  const double length_m = std::max(extents.length_m(), extents.span_m());
  const double focal_px = 900, range_m = focal_px * length_m / size_px;
  const lens::Lens lens(lens::Pinhole{{focal_px, focal_px}, {kWidth / 2.0, kHeight / 2.0}},
                        {kWidth, kHeight});
  const Rigid world_from_cam{cam_from_body().conjugate(), Vector3::Zero()};
  const Rigid world_from_aircraft{world_from_body(attitude), Vector3(range_m, 0, 0)};
  const projection::Sight sight{&lens, world_from_cam.inverse(), Homography::Identity()};
  const projection::SilhouettePoints points{&mesh, model::silhouette_points(mesh)};
  const auto box = projection::exact_box(sight, points, world_from_aircraft, 0).box;
  const shade::Model model(mesh);
  shade::Light light;
  light.sun = light.sky = light.ground = {0.1f, 0.1f, 0.1f};
  const render::View view{&lens, world_from_cam, Homography::Identity(), kWidth, kHeight};
  const image::Layer layer =
      render::render(view, light, {{&model, world_from_aircraft, 0}}, {box}, {.quality = 3});
  image::Rgb8 sky = image::make_rgb8(kWidth, kHeight);
  std::fill_n(sky.samples.get(), 3 * kWidth * kHeight, std::uint8_t{170});
  image::Picture picture = image::picture_from_rgb8(
      sky, {image::Chroma::k444, image::Matrix::kRgb, image::Range::kFull});
  composite::composite_matte(picture, layer, {});
  // What a camera's spread makes of it.
  for (image::Plane& plane : picture.planes) {
    cv::Mat samples(kHeight, kWidth, CV_8UC1, plane.samples.get(), plane.stride);
    cv::GaussianBlur(samples, samples, {}, 0.8);
  }
  const auto seen = appearance::seen_in(picture, *box);
  return seen ? seen->mask : cv::Mat();
}

double angle_deg(const YawPitchRoll& a, const YawPitchRoll& b) {
  return degrees(world_from_body(a).angularDistance(world_from_body(b)));
}

void expect_found_again(const YawPitchRoll& truth) {
  const fleet::Aircraft aircraft = fleet::load_aircraft("738/738-Delta");
  const cv::Mat mask = mask_in_the_sky(aircraft.mesh, truth, 45);
  ASSERT_FALSE(mask.empty());
  const PoseFit fit = fit_types({mask}, {"738/738-Delta"}, {})[0];
  EXPECT_GT(fit.overlap, 0.8);
  EXPECT_NEAR(fit.aspect_ratio, 1, 0.15);
  EXPECT_LT(angle_deg(fit.attitude, truth), 15)
      << fit.attitude.yaw_deg << " " << fit.attitude.pitch_deg << " " << fit.attitude.roll_deg;
}

TEST(Types, ToMatchAreInstalledAndOfTheClassThatIsAskedFor) {
  for (const bool helicopters : {false, true})
    for (const std::string& type : types_to_match(helicopters)) {
      EXPECT_EQ(fleet::aircraft_fitting(type), std::vector{type});
      EXPECT_EQ(type.starts_with("helicopter-"), helicopters) << type;
    }
}

// Both are seen from below.
TEST(Pose, AnAircraftThatComesNearerNoseUpIsFoundAgainInItsPicture) {
  expect_found_again({-60, -12, 5});
}

TEST(Pose, AnAircraftThatGoesAwayNoseDownIsFoundAgainInItsPicture) {
  expect_found_again({160, 20, 15});
}

TEST(Pose, TheTypeIsFoundAmongOthers) {
  const fleet::Aircraft aircraft = fleet::load_aircraft("c172/news");
  const cv::Mat mask = mask_in_the_sky(aircraft.mesh, {100, 20, 10}, 40);
  ASSERT_FALSE(mask.empty());
  std::string said;
  const std::vector<PoseFit> fits = fit_types({mask},
                                              {"738/738-Delta", "no-such/aircraft", "c172/news"},
                                              [&](const std::string& message) { said += message; });
  ASSERT_FALSE(fits.empty());
  EXPECT_EQ(fits[0].aircraft, "c172/news");
  for (std::size_t i = 1; i < fits.size(); ++i)
    EXPECT_TRUE(fits[i].aircraft != fits[0].aircraft ||
                angle_deg(fits[i].attitude, fits[0].attitude) >= 30);
  EXPECT_NE(said.find("no-such/aircraft"), std::string::npos);
}

}  // namespace
}  // namespace airtruth::match
