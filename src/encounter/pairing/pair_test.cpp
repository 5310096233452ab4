// SPDX-License-Identifier: Apache-2.0
#include "encounter/pairing/pair.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "support/chi_square.h"

namespace airtruth::pairing {
namespace {

using track::Track;

// A minute of flight with samples each second, at a steady turn rate.
Track flown(double speed_mps, double climb_mps, double turn_dps, double course_deg = 0) {
  Track track{"a", {}, {}, {}};
  Vector3 position(0, 0, -1000);
  for (int i = 0; i <= 60; ++i) {
    const double course = radians(course_deg + turn_dps * i);
    track.times_s.push_back(i);
    track.positions_ned_m.push_back(position);
    track.velocities_ned_mps.emplace_back(
        speed_mps * std::cos(course), speed_mps * std::sin(course), -climb_mps);
    // The chord of an arc.
    const double half = radians(turn_dps) / 2;
    const double chord = half == 0 ? speed_mps : speed_mps * std::sin(half) / half;
    position +=
        Vector3(chord * std::cos(course + half), chord * std::sin(course + half), -climb_mps);
  }
  return track;
}

// The horizontal closest approach of two straight lines (shared formula: t = -s v / v v).
struct Lines {
  double time_s, distance_m;
};
Lines closest_of(const Track& own, const Track& intruder) {
  const Vector3 s = own.positions_ned_m[0] - intruder.positions_ned_m[0];
  const Vector3 v = own.velocities_ned_mps[0] - intruder.velocities_ned_mps[0];
  const double time_s = -s.head<2>().dot(v.head<2>()) / v.head<2>().squaredNorm();
  return {time_s, (s.head<2>() + v.head<2>() * time_s).norm()};
}

TEST(Pair, TheClosestApproachIsWhereItWasDrawn) {
  const Track own = flown(60, 2, 0, 30);
  for (const double course_deg : {180.0, 90.0, -60.0, 10.0})
    for (const double hmd_m : {-200.0, 5.0, 300.0}) {
      Track intruder = flown(45, -3, 0, 211);
      place(intruder, own, {25, course_deg, hmd_m, 40});
      const auto [time_s, distance_m] = closest_of(own, intruder);
      EXPECT_NEAR(time_s, 25, 1e-6) << course_deg << " " << hmd_m;
      EXPECT_NEAR(distance_m, std::abs(hmd_m), 1e-6) << course_deg << " " << hmd_m;
      EXPECT_NEAR(own.positions_ned_m[25].z() - intruder.positions_ned_m[25].z(), 40, 1e-9);
      const Vector3& velocity = intruder.velocities_ned_mps[25];
      EXPECT_NEAR(
          std::remainder(degrees(std::atan2(velocity.y(), velocity.x())) - 30 - course_deg, 360),
          0,
          1e-9);
      EXPECT_NEAR(least_distance_m(own, intruder), std::abs(hmd_m), 1e-6);
    }
}

TEST(Pair, APositiveDistanceIsToTheRightOfAHeadOnIntruder) {
  const Track own = flown(60, 0, 0);
  Track intruder = flown(50, 0, 0);
  place(intruder, own, {30, 180, 100, 0});
  EXPECT_NEAR(intruder.positions_ned_m[30].y(), 100, 1e-9);
  place(intruder, own, {30, 180, -100, 0});
  EXPECT_NEAR(intruder.positions_ned_m[30].y(), -100, 1e-9);
  // In formation: there is no closest approach, and the distance is to the right.
  Track same = flown(60, 0, 0);
  place(same, own, {30, 0, 80, 0});
  EXPECT_LT((same.positions_ned_m[10] - own.positions_ned_m[10] - Vector3(0, 80, 0)).norm(), 1e-9);
}

TEST(Pair, TheDistanceOfTurningTracksIsStationary) {
  const Track own = flown(60, 0, 1.5);
  Track intruder = flown(40, 0, -4);
  place(intruder, own, {20, 130, 150, 0});
  const auto distance = [&](double time_s) {
    return (track::state_at(own, time_s).position_ned_m -
            track::state_at(intruder, time_s).position_ned_m)
        .head<2>()
        .norm();
  };
  EXPECT_NEAR(distance(20), 150, 1e-9);
  EXPECT_NEAR((distance(20.01) - distance(19.99)) / 0.02, 0, 1e-3);
}

TEST(Pair, LeastDistanceSeesBetweenSamplesOfDifferentTimes) {
  const Track own{"own", {0, 10}, {{0, 0, 0}, {0, 0, 0}}, {}};
  const Track passing{"b", {3, 4, 8}, {{-10, 7, 0}, {-4, 7, 0}, {20, 7, 0}}, {}};
  EXPECT_NEAR(least_distance_m(own, passing), 7, 1e-12);
  const Track later{"c", {20, 30}, {{0, 0, 0}, {1, 0, 0}}, {}};
  EXPECT_EQ(least_distance_m(own, later), HUGE_VAL);
}

TEST(Pair, TheMeanRelativeSpeedIsTheIntegralOverTheCourse) {
  for (const auto& [a, b, climb] : std::vector<std::array<double, 3>>{
           {60, 40, 5}, {50, 50, 0}, {0, 30, 0}, {30, 0, 4}, {0, 0, 3}, {80, 1, -10}}) {
    // The mean of a periodic function converges faster than any power with equal steps, but for the
    // corner of equal speeds, which costs some 1e-6.
    constexpr int kSteps = 20000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double course = 2 * kPi * (i + 0.5) / kSteps;
      sum += std::sqrt(a * a + b * b - 2 * a * b * std::cos(course) + climb * climb);
    }
    EXPECT_NEAR(mean_relative_speed_mps(a, b, climb), sum / kSteps, 1e-5) << a << " " << b;
  }
  EXPECT_NEAR(mean_relative_speed_mps(50, 50, 0), 4 * 50 / kPi, 1e-12);
}

struct Drawn {
  std::vector<Pairing> pairings;
  double mean_mps = 0;
};
Drawn draw_many(const PairingOptions& options, int count) {
  const Track own = flown(60, 0, 0), free = flown(45, 4, 0);
  Drawn drawn{{}, mean_relative_speed_mps(60, 45, 4)};
  for (int i = 0; i < count; ++i) {
    Random random = Seed(3).stream("test", static_cast<std::uint64_t>(i));
    Track intruder = free;
    drawn.pairings.push_back(*pair(own, intruder, options, random));
  }
  return drawn;
}

// Most draws are near, as a user wants them; the weights make the traffic uniform again.
PairingOptions mostly_near() {
  PairingOptions options;
  options.hmd_m = Distribution({-1000, -200, 200, 1000}, {1, 8, 1});
  options.vmd_m = Distribution({-300, -50, 50, 300}, {1, 2, 1});
  return options;
}

TEST(Pair, WeightsSumToTheRateOfEncounters) {
  const Drawn drawn = draw_many(mostly_near(), 20000);
  double sum = 0, squares = 0;
  for (const Pairing& pairing : drawn.pairings) {
    const double ratio = pairing.weight / drawn.mean_mps;
    sum += ratio;
    squares += ratio * ratio;
  }
  const double count = static_cast<double>(drawn.pairings.size());
  const double error = std::sqrt((squares / count - 1) / count);
  EXPECT_LT(error, 0.02);
  EXPECT_NEAR(sum / count, 1, 4 * error);
}

TEST(Pair, ARangeOnOneSideHasHalfOfTheTraffic) {
  PairingOptions options = mostly_near();
  options.hmd_m = Distribution({0, 100, 1000}, {1, 1});
  options.vmd_m = Distribution({-100, 300});
  const Drawn drawn = draw_many(options, 20000);
  double sum = 0, squares = 0;
  for (const Pairing& pairing : drawn.pairings) {
    sum += pairing.weight / drawn.mean_mps;
    squares += std::pow(pairing.weight / drawn.mean_mps, 2);
  }
  const double count = static_cast<double>(drawn.pairings.size()), mean = sum / count;
  EXPECT_NEAR(mean, 0.5 * 400 / 600, 4 * std::sqrt((squares / count - mean * mean) / count));
}

// A near mid-air collision, within 152.4 m and 30.48 m, has the share of its area.
TEST(Pair, WeightedSharesAreThoseOfUniformTraffic) {
  const Drawn drawn = draw_many(mostly_near(), 40000);
  double all = 0, near = 0, squares = 0;
  for (const Pairing& pairing : drawn.pairings) {
    all += pairing.weight;
    if (std::abs(pairing.approach.hmd_m) > 152.4 || std::abs(pairing.approach.vmd_m) > 30.48)
      continue;
    near += pairing.weight;
    squares += pairing.weight * pairing.weight;
  }
  const double expected = 152.4 / 1000 * 30.48 / 300;
  EXPECT_NEAR(near / all, expected, 4 * std::sqrt(squares) / all);
}

TEST(Pair, CoursesAreAsFrequentAsTheirRelativeSpeed) {
  const Drawn drawn = draw_many(mostly_near(), 40000);
  constexpr int kBins = 36;
  std::vector<double> counts(kBins), probabilities(kBins);
  double inverse = 0;
  const auto relative_mps = [](double course_deg) {
    return std::sqrt(60 * 60 + 45 * 45 - 2 * 60 * 45 * std::cos(radians(course_deg)) + 4 * 4);
  };
  for (const Pairing& pairing : drawn.pairings) {
    const double course = pairing.approach.course_deg;
    ++counts[static_cast<std::size_t>(std::floor((course + 180) / 10))];
    inverse += drawn.mean_mps / relative_mps(course);
  }
  for (int k = 0; k < kBins; ++k)
    for (int i = 0; i < 100; ++i)
      probabilities[static_cast<std::size_t>(k)] +=
          relative_mps(-180 + 10 * k + 0.1 * (i + 0.5)) / drawn.mean_mps / (36 * 100);
  test_support::ChiSquare chi;
  chi.add(counts, probabilities);
  EXPECT_EQ(chi.degrees, 35);
  EXPECT_LT(chi.normal_deviate(), test_support::kLevel0001);
  // Undoing the acceptance gives uniform courses back.
  EXPECT_NEAR(inverse / static_cast<double>(drawn.pairings.size()), 1, 0.02);
}

TEST(Pair, DistancesFollowTheirBins) {
  const Drawn drawn = draw_many(mostly_near(), 20000);
  std::vector<double> hmd(3), vmd(3);
  for (const Pairing& pairing : drawn.pairings) {
    ++hmd[pairing.approach.hmd_m < -200 ? 0 : pairing.approach.hmd_m < 200 ? 1 : 2];
    ++vmd[pairing.approach.vmd_m < -50 ? 0 : pairing.approach.vmd_m < 50 ? 1 : 2];
  }
  test_support::ChiSquare chi;
  chi.add(hmd, {0.1, 0.8, 0.1});
  chi.add(vmd, {0.25, 0.5, 0.25});
  EXPECT_LT(chi.normal_deviate(), test_support::kLevel0001);
}

TEST(Pair, NoEncounterComesCloserThanItsDistance) {
  PairingOptions options = mostly_near();
  options.cpa_time_s = 30;
  const Track own = flown(60, 0, 0);
  int empty = 0;
  for (std::uint64_t i = 0; i < 300; ++i) {
    Random random = Seed(9).stream("turning", i);
    Track intruder = flown(50, 0, 6);
    const auto pairing = pair(own, intruder, options, random);
    if (!pairing) {
      ++empty;
      continue;
    }
    EXPECT_GE(least_distance_m(own, intruder), std::abs(pairing->approach.hmd_m) - 5);
  }
  EXPECT_EQ(empty, 0);
}

TEST(Pair, WhatCannotBePairedIsAnErrorOrEmpty) {
  const Track own = flown(60, 0, 0);
  Track intruder = flown(50, 0, 0);
  Random random(1);
  PairingOptions late;
  late.cpa_time_s = 61;
  EXPECT_THROW(pair(own, intruder, late, random), Error);
  PairingOptions fixed;
  fixed.hmd_m = Distribution({50});
  EXPECT_THROW(pair(own, intruder, fixed, random), Error);
  Track point{"p", {0}, {{0, 0, 0}}, {{0, 0, 0}}};
  EXPECT_THROW(place(point, own, {0, 0, 0, 0}), Error);
  Track still = flown(0, 0, 0), other = flown(0, 0, 0);
  EXPECT_FALSE(pair(still, other, {}, random).has_value());
}

TEST(Distribution, QuantileAndDensityBelongTogether) {
  const Distribution d({-10, 0, 10, 40}, {1, 0, 3});
  EXPECT_DOUBLE_EQ(d.quantile(0), -10);
  EXPECT_DOUBLE_EQ(d.quantile(0.125), -5);
  EXPECT_DOUBLE_EQ(d.quantile(0.25), 10);  // the empty bin is passed over
  EXPECT_DOUBLE_EQ(d.quantile(0.625), 25);
  EXPECT_DOUBLE_EQ(d.quantile(1), 40);
  EXPECT_DOUBLE_EQ(d.density(-5), 0.025);
  EXPECT_DOUBLE_EQ(d.density(5), 0);
  EXPECT_DOUBLE_EQ(d.density(40), 0.025);
  EXPECT_DOUBLE_EQ(d.density(41), 0);
  EXPECT_DOUBLE_EQ(Distribution({7}).quantile(0.3), 7);
  EXPECT_DOUBLE_EQ(Distribution({0, 1, 10}).density(5), 0.1);
}

TEST(Distribution, BadEdgesAndSharesAreErrors) {
  EXPECT_THROW(Distribution({}), Error);
  EXPECT_THROW(Distribution({1, 1}), Error);
  EXPECT_THROW(Distribution({1, 0}), Error);
  EXPECT_THROW(Distribution({0, NAN}), Error);
  EXPECT_THROW(Distribution({0, 1, 2}, {1}), Error);
  EXPECT_THROW(Distribution({0, 1, 2}, {1, -1}), Error);
  EXPECT_THROW(Distribution({0, 1, 2}, {0, 0}), Error);
}

}  // namespace
}  // namespace airtruth::pairing
