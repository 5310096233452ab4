// SPDX-License-Identifier: Apache-2.0
#include "calibration/air/sun.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <Eigen/Cholesky>

namespace airtruth::air {
namespace {

// Where a constant of this file states no origin, it was chosen on the virtual flights of
// surroundings_slow_test.cpp, whose figures are in docs/realism.md.

// Least number of samples of the sky.
constexpr std::size_t kMinSkySamples = 2000;
// Number of samples that the fits use, at least; they bound the time.
constexpr std::size_t kFittedSamples = 4000;
// Weight of a sample brighter than the fit. That of a darker one is 1 - kBrightWeight.
constexpr double kBrightWeight = 0.12;
// Rounds of reweighting.
constexpr int kReweightingRounds = 6;
// Light of a saturated pixel, linear.
constexpr double kSaturated = 1;
// The cost of a direction that is no candidate.
constexpr double kNoFit = 1e300;
// Spacing of the directions that are tried, degrees, and their elevations.
constexpr double kGridElevationDeg = 10, kGridAzimuthDeg = 15;
constexpr double kFirstElevationDeg = 5, kLastElevationDeg = 85;
// Refinement: the first and the last spacing of the directions, degrees, and the ratio of one to
// the one before.
constexpr double kFirstStepDeg = 6, kLastStepDeg = 0.8, kStepRatio = 0.6;
// Bounds of the elevation that is found.
constexpr double kMinElevationDeg = 1, kMaxElevationDeg = 89;
// A direction explains the sky nearly as well as the best if its cost exceeds the least by less
// than this share of the range of costs: chosen so that the error covers the truth on virtual
// flights (surroundings_slow_test.cpp).
constexpr double kMaxExcessCostShare = 0.06;
// Bounds of the angle, degrees, to the farthest such direction.
constexpr double kMinSpreadDeg = 4, kMaxSpreadDeg = 45;
// Least ratio between the greatest and the least cost.
constexpr double kMinCostRatio = 1.03;

using Terms = Eigen::Matrix<double, 8, 1>;

struct Direction {
  double azimuth_deg = 0, elevation_deg = 0;

  Vector3 vector() const { return unit_vector(azimuth_deg, elevation_deg); }
};

// The terms of the light from the direction `d`: four of the height, four of the angle to the sun.
Terms terms_of(const Vector3& d, const Vector3& sun) {
  const double up = std::max(0.0, -d.z());
  const double cosine = d.dot(sun);
  const double toward = std::max(0.0, cosine);
  const double p8 = std::pow(toward, 8);
  Terms row;
  row << 1, up, up * up, std::exp(-10 * up), cosine * cosine, p8, p8 * p8 * p8 * p8 * p8 * p8,
      toward * toward;
  return row;
}

// The cost of the best sky with the sun in one direction; kNoFit if that sky is not brighter
// towards the sun.
double cost_of(const std::vector<SkySample>& samples, const Vector3& sun) {
  std::vector<Terms> rows;
  for (const SkySample& s : samples) rows.push_back(terms_of(s.direction, sun));
  Terms solution = Terms::Zero();
  double cost = 0;
  for (int round = 0; round < kReweightingRounds; ++round) {
    Eigen::Matrix<double, 8, 8> normal = Eigen::Matrix<double, 8, 8>::Identity() * 1e-6;
    Terms right = Terms::Zero();
    cost = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double light = std::min(samples[i].light, kSaturated);
      const double e = light - rows[i].dot(solution);
      const double w = round == 0 ? 0.5 : (e > 0 ? kBrightWeight : 1 - kBrightWeight);
      cost += w * e * e;
      normal += w * rows[i] * rows[i].transpose();
      right += w * light * rows[i];
    }
    solution = normal.ldlt().solve(right);
  }
  const double glow = solution[4] + solution[5] + solution[6] + solution[7];
  return glow > 0 ? cost : kNoFit;
}

// The directions that were tried, with their costs, and the best of them.
struct Search {
  Direction best;
  double least = kNoFit, greatest = 0;
  std::vector<std::pair<Vector3, double>> all;
};

Search over_grid(const std::vector<SkySample>& samples) {
  Search search;
  for (double e = kFirstElevationDeg; e <= kLastElevationDeg; e += kGridElevationDeg)
    for (double a = -180; a < 180; a += kGridAzimuthDeg / std::cos(radians(e))) {
      const Vector3 sun = Direction{a, e}.vector();
      const double cost = cost_of(samples, sun);
      if (cost < kNoFit) {
        search.greatest = std::max(search.greatest, cost);
        search.all.push_back({sun, cost});
      }
      if (cost < search.least) search.least = cost, search.best = {a, e};
    }
  return search;
}

// Searches the neighbours of the best direction at ever finer spacings.
void refine(Search& search, const std::vector<SkySample>& samples) {
  for (double step = kFirstStepDeg; step > kLastStepDeg; step *= kStepRatio) {
    const auto [a0, e0] = search.best;
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j) {
        const double a = a0 + i * step / std::cos(radians(e0));
        const double e = std::clamp(e0 + j * step, kMinElevationDeg, kMaxElevationDeg);
        const double cost = cost_of(samples, Direction{a, e}.vector());
        if (cost < search.least) search.least = cost, search.best = {a, e};
      }
  }
}

// The angle, degrees, to the farthest direction that explains the sky nearly as well.
double spread_deg(const Search& search) {
  const Vector3 found = search.best.vector();
  const double most = search.least + kMaxExcessCostShare * (search.greatest - search.least);
  double spread = kMinSpreadDeg;
  for (const auto& [direction, cost] : search.all)
    if (cost < most)
      spread = std::max(spread, degrees(std::acos(std::clamp(direction.dot(found), -1.0, 1.0))));
  return spread;
}

}  // namespace

Measured<Sun> sun_of(const std::vector<SkySample>& sky) {
  if (sky.size() < kMinSkySamples) return NotMeasured{"too little sky is seen"};
  const std::size_t stride = std::max<std::size_t>(1, sky.size() / kFittedSamples);
  std::vector<SkySample> samples;
  for (std::size_t i = 0; i < sky.size(); i += stride) samples.push_back(sky[i]);
  Search search = over_grid(samples);
  if (search.all.empty()) return NotMeasured{"the sky is brightest nowhere"};
  refine(search, samples);
  const double spread = spread_deg(search);
  if (spread > kMaxSpreadDeg || search.greatest < kMinCostRatio * search.least)
    return NotMeasured{"the sky does not say where it is (it would be known to " +
                       std::to_string(static_cast<int>(spread)) + " degrees)"};
  const double azimuth = search.best.azimuth_deg;
  const double turn = azimuth > 180 ? azimuth - 360 : azimuth < -180 ? azimuth + 360 : azimuth;
  return Sun{{turn, spread / 2}, {search.best.elevation_deg, spread / 2}};
}

}  // namespace airtruth::air
