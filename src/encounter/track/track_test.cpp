// SPDX-License-Identifier: Apache-2.0
#include "encounter/track/track.h"

#include <cmath>

#include <gtest/gtest.h>

namespace airtruth::track {
namespace {

// A circle of 500 m at 50 m/s, and its exact velocity.
Vector3 on_circle(double t) { return {500 * std::sin(t / 10), 500 - 500 * std::cos(t / 10), -t}; }
Vector3 circle_velocity(double t) { return {50 * std::cos(t / 10), 50 * std::sin(t / 10), -1}; }

Track circle(double step_s) {
  Track track{"circle", {}, {}, {}};
  for (int i = 0; i * step_s <= 20; ++i) {
    track.times_s.push_back(i * step_s);
    track.positions_ned_m.push_back(on_circle(i * step_s));
  }
  return track;
}

TEST(Track, VelocitiesAreExactOnAParabolaWithUnevenTimes) {
  Track track{"", {0, 1, 4, 5}, {}, {}};
  for (const double t : track.times_s) track.positions_ned_m.emplace_back(t * t, 3 * t, 7 - t);
  const auto velocities = velocities_of(track);
  ASSERT_EQ(velocities.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_LT((velocities[i] - Vector3(2 * track.times_s[i], 3, -1)).norm(), 1e-12) << i;
}

TEST(Track, VelocitiesOfACircleConvergeWithTheSquareOfTheStep) {
  const auto error = [](double step_s) {
    const Track track = circle(step_s);
    const auto velocities = velocities_of(track);
    const std::size_t middle = track.size() / 2;
    return (velocities[middle] - circle_velocity(track.times_s[middle])).norm();
  };
  // The error of a central difference is step^2 |p'''| / 6 = step^2 0.5 / 6 m/s.
  EXPECT_NEAR(error(1.0), 0.5 / 6, 1e-3);
  EXPECT_NEAR(error(0.5), 0.125 / 6, 1e-3);
}

TEST(Track, StatedVelocitiesStay) {
  const Track track{"", {0, 1}, {{0, 0, 0}, {1, 0, 0}}, {{5, 0, 0}, {6, 0, 0}}};
  EXPECT_EQ(velocities_of(track)[1].x(), 6);
}

TEST(Track, StateFollowsACircleBetweenItsSamples) {
  Track track = circle(1.0);
  for (const double t : track.times_s) track.velocities_ned_mps.push_back(circle_velocity(t));
  // The error of cubic Hermite interpolation is at most step^4 |p''''| / 384 = 0.05 / 384 m.
  for (double t = 0; t <= 20; t += 0.13) {
    const TrackState state = state_at(track, t);
    EXPECT_LT((state.position_ned_m - on_circle(t)).norm(), 2 * 0.05 / 384) << t;
    EXPECT_LT((state.velocity_ned_mps - circle_velocity(t)).norm(), 1e-3) << t;
  }
}

TEST(Track, FurtherSamplesLieOnTheTrack) {
  Track track = circle(1.0);
  for (const double t : track.times_s) track.velocities_ned_mps.push_back(circle_velocity(t));
  const Track more = with_samples_at(track, {-1, 0.5, 3, 7.25, 20, 30});
  ASSERT_EQ(more.size(), track.size() + 2);
  EXPECT_EQ(more.times_s[1], 0.5);
  for (std::size_t i = 0; i < more.size(); ++i)
    EXPECT_LT((more.positions_ned_m[i] - on_circle(more.times_s[i])).norm(), 1e-3) << i;
  EXPECT_EQ(more.positions_ned_m[2], track.positions_ned_m[1]);
}

TEST(Track, TimesOutsideGiveTheNearestEnd) {
  const Track track = with_velocities(circle(1.0));
  EXPECT_EQ(state_at(track, -5).position_ned_m, track.positions_ned_m.front());
  EXPECT_EQ(state_at(track, 50).position_ned_m, track.positions_ned_m.back());
}

TEST(Track, TurnsFromNorthTowardsEastAboutThePivot) {
  Track track{"", {0, 1}, {{10, 0, -5}, {20, 0, -5}}, {{10, 0, 1}, {10, 0, 1}}};
  turn_and_move(track, kPi / 2, {10, 0, 0}, {0, 100, -1});
  EXPECT_LT((track.positions_ned_m[0] - Vector3(10, 100, -6)).norm(), 1e-12);
  EXPECT_LT((track.positions_ned_m[1] - Vector3(10, 110, -6)).norm(), 1e-12);
  EXPECT_LT((track.velocities_ned_mps[0] - Vector3(0, 10, 1)).norm(), 1e-12);
}

}  // namespace
}  // namespace airtruth::track
