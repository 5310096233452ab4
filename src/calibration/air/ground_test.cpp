// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "calibration/air/ground_track.h"
#include "calibration/air/same_ground.h"
#include "foundation/base/error.h"
#include "scene/synthetic/flight.h"

// Ground that is seen again: the path of the camera over it, and the effect of the air on its
// light.
namespace airtruth::air {
namespace {

struct Flown {
  synthetic::Flight flight;
  std::vector<image::Picture> pictures;
  std::vector<GroundView> views;
};

// One frame per second, each with its true attitude, except that the assumed horizon ahead lies
// `horizon_deg` below the true one.
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
  const auto track = track_ground({f.views, f.flight.lens()});
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
  EXPECT_FALSE(track_ground({views, lens}));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(track_ground({views, lens}, stop.get_token()), Interrupted);
}

// Squares with random light that the camera approaches, and the ground beyond them. The sky is seen
// in half of the sectors only, is brighter towards the sun, and has a small error.
TEST(SameGround, TellsExtinctionAndAirlight) {
  const std::array<double, 3> extinction_per_km{0.27, 0.3, 0.36};
  const auto airlight = [](std::size_t c, int sector) {
    return (0.5 + 0.1 * double(c)) * (1 + 0.2 * sector / kSectors);
  };
  SkyCurves sky;
  for (int sector = 0; sector < kSectors / 2; ++sector) {
    auto& curve = sky[static_cast<std::size_t>(sector)].emplace();
    for (std::size_t c = 0; c < 3; ++c)
      curve.by_channel[c] = {airlight(c, sector) * (sector % 2 == 0 ? 0.97 : 1.01), 0, 0};
  }
  constexpr double kAltitude_m = 120;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> own(0.03, 0.4), noise(-0.002, 0.002);
  const auto seen_as = [&](const std::array<double, 3>& light, int sector, double range) {
    std::array<double, 3> seen{};
    for (std::size_t c = 0; c < 3; ++c) {
      const double t = std::exp(-extinction_per_km[c] * 1e-3 * kAltitude_m * range);
      seen[c] = airlight(c, sector) + (light[c] - airlight(c, sector)) * t + noise(random);
    }
    return seen;
  };
  GroundSeen seen;
  for (int square = 0; square < 200; ++square) {
    const std::array<double, 3> light{own(random), own(random), own(random)};
    for (double range = 3 + 0.02 * square; range < 20; range += 1.5)
      seen.squares.push_back(
          {square, square % kSectors, range, seen_as(light, square % kSectors, range)});
  }
  for (int sector = 0; sector < kSectors; ++sector)
    for (double range = 20; range < 400; range *= 1.4)
      seen.far.push_back({sector, range, seen_as({0.22, 0.2, 0.21}, sector, range)});
  const auto found = fading_of_same_ground(seen, sky, kAltitude_m);
  ASSERT_TRUE(found);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(
        found->extinction_per_km[c].value, extinction_per_km[c], 0.02 * extinction_per_km[c]);
    EXPECT_NEAR(found->airlight[c].value, airlight(c, 5), 0.02 * airlight(c, 5));
  }
  // From a single place no ground is seen at two ranges.
  GroundSeen near = seen;
  near.far.clear();
  std::erase_if(near.squares, [](const SquareSeen& s) { return s.range > 5; });
  EXPECT_FALSE(fading_of_same_ground(near, sky, kAltitude_m));
  // There is no answer either if each square is seen only once, however many there are.
  GroundSeen once;
  for (int square = 0; square < 1000; ++square)
    once.squares.push_back(
        {square, 0, 3 + 0.015 * square, {own(random), own(random), own(random)}});
  EXPECT_FALSE(fading_of_same_ground(once, sky, kAltitude_m));
}

}  // namespace
}  // namespace airtruth::air
