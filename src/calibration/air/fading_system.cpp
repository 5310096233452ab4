// SPDX-License-Identifier: Apache-2.0
#include "calibration/air/fading_system.h"

#include <cmath>

namespace airtruth::calibration {
namespace {

// Where a constant of this file states no origin, it was chosen on the virtual flights of
// surroundings_slow_test.cpp, whose figures are in docs/realism.md.

// Error of the light of far ground: as a share of the light of the mean ground, and its lower bound
// in linear light.
constexpr double kFarError = 0.25, kMinFarError = 0.006;
// Range in heights at which the loss of contrast among squares is stated.
constexpr double kMixedRange = 15;

}  // namespace

void System::expect(int unknown, double value, double trust) {
  const double weight = 1 / (trust * value * trust * value);
  aa(unknown, unknown) += weight, ay[unknown] += weight * value, yy += weight * value * value;
}

void System::add_square(const Row& r, double t) {
  Square& q = squares[static_cast<std::size_t>(r.square)];
  const double air = 1 - t;
  const double mixed = t * r.contrast * r.range * r.range / (kMixedRange * kMixedRange);
  q.tt += r.weight * t * t, q.ty += r.weight * t * r.light;
  q.ta[r.sector] += r.weight * t * air, q.ta[kMixed] += r.weight * t * mixed;
  aa(r.sector, r.sector) += r.weight * air * air, aa(kMixed, kMixed) += r.weight * mixed * mixed;
  aa(r.sector, kMixed) += r.weight * air * mixed, aa(kMixed, r.sector) += r.weight * air * mixed;
  ay[r.sector] += r.weight * air * r.light, ay[kMixed] += r.weight * mixed * r.light;
  yy += r.weight * r.light * r.light;
}

void System::eliminate_own_light() {
  for (const Square& q : squares) {
    if (q.tt == 0) continue;
    aa -= q.ta * q.ta.transpose() / q.tt, ay -= q.ta * q.ty / q.tt, yy -= q.ty * q.ty / q.tt;
  }
}

void System::add_far(const Row& r, double t, double mean_light) {
  const double error = std::hypot(kMinFarError, kFarError * mean_light * t);
  const double w = 1 / (error * error);
  Unknowns row = Unknowns::Zero();
  row[r.sector] = 1 - t, row[kMean] = t;
  aa += w * row * row.transpose(), ay += w * r.light * row, yy += w * r.light * r.light;
}

}  // namespace airtruth::calibration
