// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "base/error.h"
#include "calibration/ground_track.h"
#include "calibration/same_ground.h"
#include "synthetic/flight.h"

// Ground that is seen again: where the camera was over it, and what the air does to its light.
namespace airtruth::calibration {
namespace {

struct Flown {
  synthetic::Flight flight;
  std::vector<image::Picture> pictures;
  std::vector<GroundView> views;
};

// A frame a second, each with its true attitude, but what it takes for level ahead lies so much
// below the true horizon.
Flown flown(double horizon_deg) {
  synthetic::FlightOptions o;
  o.seed = 9;
  o.width = 480, o.height = 360;
  o.frame_rate_hz = 1, o.frame_count = 24;
  o.speed_mps = 50;
  o.own_aircraft = false;
  o.ideal_sensor = true;
  o.lens = lens::fisheye_from_vertical_fov(110, {o.width, o.height});
  Flown result{synthetic::Flight(o), {}, {}};
  for (int k = 0; k < o.frame_count; ++k) result.pictures.push_back(result.flight.frame(k));
  const Quaternion world_from_tilted(
      Eigen::AngleAxisd(radians(-horizon_deg), Vector3::UnitY()));  // the flight goes north
  for (int k = 0; k < o.frame_count; ++k)
    result.views.push_back({&result.pictures[static_cast<std::size_t>(k)],
                            cam_from_body() * result.flight.camera(k).world_from_body.conjugate() *
                                world_from_tilted});
  return result;
}

TEST(GroundTrack, FindsTheWayAndTheHorizon) {
  constexpr double horizon_deg = 1.6;
  const Flown f = flown(horizon_deg);
  const auto track = track_ground(f.views, f.flight.lens(), nullptr);
  ASSERT_TRUE(track) << horizon_deg;
  ASSERT_EQ(track->places.size(), f.views.size());
  const Vector3 truth =
      (f.flight.camera(23).position_in_world - f.flight.camera(0).position_in_world) /
      f.flight.options().altitude_m;
  std::printf("moved %.3f %.3f heights, truly %.3f %.3f; horizon %.3f degrees, truly %.3f\n",
              track->places.back().x(),
              track->places.back().y(),
              truth.x(),
              truth.y(),
              degrees(track->horizon_rad),
              horizon_deg);
  EXPECT_NEAR(track->places.back().x(), truth.x(), 0.05 * truth.x());
  EXPECT_NEAR(track->places.back().y(), truth.y(), 0.05 * truth.x());
  EXPECT_NEAR(degrees(track->horizon_rad), horizon_deg, 0.3);
}

TEST(GroundTrack, WithoutGroundThereIsNone) {
  const image::Picture blank = image::make_picture(320, 240, image::Colour{});
  const lens::Lens lens = lens::pinhole_from_vertical_fov(60, {320, 240});
  const std::vector<GroundView> views(6, GroundView{&blank, cam_from_body()});
  EXPECT_FALSE(track_ground(views, lens, nullptr));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(track_ground(views, lens, nullptr, stop.get_token()), Interrupted);
}

// Squares of any light, come to from afar; the sky says an airlight that is a tenth off.
TEST(SameGround, TellsExtinctionAndAirlight) {
  const std::array<double, 3> extinction_per_km{0.27, 0.3, 0.36}, airlight{0.5, 0.6, 0.7};
  constexpr double kAltitude_m = 120;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> own(0.03, 0.4), noise(-0.002, 0.002);
  std::vector<GroundSeen> seen;
  for (int square = 0; square < 200; ++square) {
    const std::array<double, 3> light{own(random), own(random), own(random)};
    for (double range = 3 + 0.02 * square; range < 20; range += 1.5) {
      GroundSeen s{square, range, {}};
      for (std::size_t c = 0; c < 3; ++c) {
        const double t = std::exp(-extinction_per_km[c] * 1e-3 * kAltitude_m * range);
        s.light[c] = airlight[c] + (light[c] - airlight[c]) * t + noise(random);
      }
      seen.push_back(s);
    }
  }
  const auto found =
      fading_of_same_ground(seen, {{{0.45, 0.05}, {0.65, 0.05}, {0.75, 0.05}}}, kAltitude_m);
  ASSERT_TRUE(found);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(
        found->extinction_per_km[c].value, extinction_per_km[c], 0.04 * extinction_per_km[c]);
    EXPECT_NEAR(found->airlight[c].value, airlight[c], 0.03 * airlight[c]);
  }
  // From one place alone nothing is seen again.
  std::erase_if(seen, [](const GroundSeen& s) { return s.range > 5; });
  EXPECT_FALSE(
      fading_of_same_ground(seen, {{{0.45, 0.05}, {0.65, 0.05}, {0.75, 0.05}}}, kAltitude_m));
  // Nor where there is much ground, but each square is seen once.
  seen.clear();
  for (int square = 0; square < 1000; ++square)
    seen.push_back({square, 3 + 0.015 * square, {own(random), own(random), own(random)}});
  EXPECT_FALSE(
      fading_of_same_ground(seen, {{{0.45, 0.05}, {0.65, 0.05}, {0.75, 0.05}}}, kAltitude_m));
}

}  // namespace
}  // namespace airtruth::calibration
