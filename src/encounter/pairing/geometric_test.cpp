// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "encounter/pairing/pair.h"
#include "foundation/base/error.h"

namespace airtruth::pairing {
namespace {

track::Track own_track() {
  track::Track own{"own", {}, {}, {}};
  for (int i = 0; i <= 60; ++i) {
    own.times_s.push_back(i);
    own.positions_ned_m.emplace_back(0, 50.0 * i, -500);
    own.velocities_ned_mps.emplace_back(0, 50, 0);
  }
  return own;
}

TEST(Geometric, EveryPartOfEveryDistributionIsDrawnOnce) {
  GeometricOptions options;
  options.climb_mps = Distribution({-5, 0, 5}, {1, 3});
  options.turn_rate_dps = Distribution({-3, 3});
  constexpr std::uint64_t kCount = 40;
  const GeometricSampler sampler(options, 4, kCount);
  std::vector<double> courses, climbs, speeds;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const Geometry geometry = sampler.draw(i);
    courses.push_back(geometry.approach.course_deg);
    climbs.push_back(geometry.climb_mps);
    speeds.push_back(geometry.speed_mps);
    EXPECT_EQ(geometry.approach.time_s, 30);
  }
  for (auto* values : {&courses, &climbs, &speeds}) std::sort(values->begin(), values->end());
  for (int i = 0; i < 40; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_GE(courses[k], -180 + 9.0 * i);
    EXPECT_LT(courses[k], -180 + 9.0 * (i + 1));
    EXPECT_GE(speeds[k], 30 + 1.25 * i);
    EXPECT_LT(speeds[k], 30 + 1.25 * (i + 1));
  }
  // A quarter of the climbs are below 0.
  EXPECT_LT(climbs[9], 0);
  EXPECT_GE(climbs[10], 0);
}

TEST(Geometric, TheTrackPassesAsDrawn) {
  const track::Track own = own_track();
  for (const double turn_dps : {0.0, 3.0, -6.0}) {
    const Geometry geometry{{20.25, 135, 120, -30}, 70, 2, turn_dps};
    const track::Track track = geometric_track(own, geometry, 0, 45.5);
    EXPECT_EQ(track.size(), 47u);
    EXPECT_EQ(track.times_s.back(), 45.5);
    const track::TrackState at = track::state_at(track, 20.25),
                            own_at = track::state_at(own, 20.25);
    const Vector3 offset = at.position_ned_m - own_at.position_ned_m;
    EXPECT_NEAR(offset.head<2>().norm(), 120, 0.01);
    EXPECT_NEAR(offset.z(), 30, 1e-9);
    const Vector3 relative = at.velocity_ned_mps - own_at.velocity_ned_mps;
    EXPECT_NEAR(offset.head<2>().dot(relative.head<2>()), 0, 0.5);
    // Constant speed, climb and turn.
    for (std::size_t i = 0; i + 2 < track.size(); ++i) {
      const Vector3 &a = track.velocities_ned_mps[i], &b = track.velocities_ned_mps[i + 1];
      EXPECT_NEAR(a.head<2>().norm(), 70, 1e-9);
      EXPECT_NEAR(a.z(), -2, 1e-12);
      EXPECT_NEAR(degrees(std::atan2(a.x() * b.y() - a.y() * b.x(), a.head<2>().dot(b.head<2>()))),
                  turn_dps,
                  1e-9);
    }
    if (turn_dps != 0) {
      // Three points give the circle's radius, abc / 4 area.
      const Eigen::Vector2d p = track.positions_ned_m[0].head<2>(),
                            q = track.positions_ned_m[9].head<2>(),
                            r = track.positions_ned_m[20].head<2>();
      const Eigen::Vector2d u = q - p, v = r - p;
      const double area = std::abs(u.x() * v.y() - u.y() * v.x()) / 2;
      EXPECT_NEAR(u.norm() * v.norm() * (r - q).norm() / (4 * area),
                  70 / radians(std::abs(turn_dps)),
                  1e-6);
    }
  }
}

TEST(Geometric, AGeometryThatTurnsBackNearerIsDrawnAgain) {
  const track::Track own = own_track();
  GeometricOptions options;
  options.hmd_m = Distribution({200, 300});
  options.turn_rate_dps = Distribution({-3, 3});
  const GeometricSampler sampler(options, 1, 500);
  int again = 0;
  for (std::uint64_t i = 0; i < 500; ++i) {
    const GeometricPassage passage = geometric_passage(sampler, i, own, 0, 60);
    EXPECT_GE(least_distance_m(own, passage.track), passage.geometry.approach.hmd_m - 5) << i;
    again += passage.draws > 1 ? 1 : 0;
    if (passage.draws > 1) continue;
    EXPECT_EQ(passage.geometry.turn_rate_dps, sampler.draw(i).turn_rate_dps);
  }
  EXPECT_GT(again, 0);
  EXPECT_LT(again, 100);
}

// It circles, 172 m in radius, about an own aircraft that hovers or beside it.
TEST(Geometric, AStatedPointThatTurnsBackNearerIsAnError) {
  const track::Track own{"own", {0, 60}, {{0, 0, -500}, {0, 0, -500}}, {{0, 0, 0}, {0, 0, 0}}};
  GeometricOptions options;
  options.course_deg = Distribution({0});
  options.speed_mps = Distribution({60});
  options.turn_rate_dps = Distribution({20});
  options.hmd_m = Distribution({200});
  EXPECT_THROW(geometric_passage(GeometricSampler(options, 1, 1), 0, own, 0, 60), Error);
  options.hmd_m = Distribution({-200});
  EXPECT_EQ(geometric_passage(GeometricSampler(options, 1, 1), 0, own, 0, 60).draws, 1);
}

TEST(Geometric, WhatCannotBeIsAnError) {
  EXPECT_THROW(GeometricSampler({}, 1, 0), Error);
  GeometricOptions options;
  options.speed_mps = Distribution({-1, 5});
  EXPECT_THROW(GeometricSampler(options, 1, 5), Error);
  EXPECT_THROW(geometric_track(own_track(), {{50, 0, 0, 0}, 10, 0, 0}, 0, 40), Error);
  EXPECT_THROW(geometric_track(own_track(), {{70, 0, 0, 0}, 10, 0, 0}, 0, 80), Error);
}

}  // namespace
}  // namespace airtruth::pairing
