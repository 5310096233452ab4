// SPDX-License-Identifier: Apache-2.0
#include "scene/scene/flock.h"

#include <algorithm>
#include <string>

#include "foundation/base/error.h"
#include "foundation/base/seed.h"
#include "scene/scene/limits.h"

namespace airtruth::scene {
namespace {

// Ratio of a flock's height to its width: a choice.
constexpr double kHeightShare = 1.0 / 3;
// Standard deviations of size and stroke rate within a flock, as shares.
constexpr double kSizeSpread = 0.04;
constexpr double kRateSpread = 0.05;

Vector3 within_ellipsoid(Random& random, double radius_m) {
  Vector3 p;
  do {
    for (double& x : p) x = random.uniform(-1, 1);
  } while (p.squaredNorm() > 1);
  return radius_m * Vector3(p.x(), p.y(), kHeightShare * p.z());
}

// A place apart from the taken ones; after many attempts any place.
Vector3 free_place(Random& random,
                   double radius_m,
                   double apart_m,
                   const std::vector<Intruder>& taken) {
  // Number of attempts: it bounds the time in a crowded flock.
  constexpr int kAttempts = 100;
  Vector3 place = Vector3::Zero();
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    place = within_ellipsoid(random, radius_m);
    if (std::ranges::none_of(taken, [&](const Intruder& other) {
          return (other.offset_ned_m - place).norm() < apart_m;
        }))
      break;
  }
  return place;
}

double varied(Random& random, double value, double spread, const Limits& limits) {
  return std::clamp(
      value * (1 + spread * std::clamp(random.normal(), -2.0, 2.0)), limits.low, limits.high);
}

}  // namespace

std::vector<Intruder> flock_of(const Intruder& leader,
                               std::int64_t count,
                               double spread_m,
                               std::uint64_t seed) {
  check(leader.distractor.has_value(), "a flock is of distractors");
  if (count <= 1) return {leader};
  std::vector<Intruder> flock;
  for (std::int64_t k = 0; k < count; ++k) {
    Random random = Seed(seed).stream("flock of " + leader.id, static_cast<std::uint64_t>(k));
    Intruder member = leader;
    member.id += "-" + std::to_string(k + 1);
    Distractor& one = *member.distractor;
    one.size_m = varied(random, one.size_m, kSizeSpread, kDistractorSize);
    one.flap_hz = varied(random, one.flap_hz, kRateSpread, kStrokeRate);
    one.flap_phase = random.uniform(0, model::kStrokesOfBout);
    // A neighbour that varies as much stays apart.
    const Vector3 place = free_place(random, spread_m, 2 * one.size_m, flock);
    member.offset_ned_m = place;
    flock.push_back(std::move(member));
  }
  for (Intruder& member : flock)
    member.offset_ned_m = (member.offset_ned_m + leader.offset_ned_m)
                              .cwiseMax(kPosition.low)
                              .cwiseMin(kPosition.high);
  return flock;
}

}  // namespace airtruth::scene
