// SPDX-License-Identifier: Apache-2.0
#include "calibration/air/extinction.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "foundation/base/median.h"

namespace airtruth::air {
namespace {

// Where a constant of this file states no origin, it was chosen on the virtual flights of
// surroundings_slow_test.cpp, whose figures are in docs/realism.md.

// Range of depressions that is used, degrees, and the number of bands into which it is divided in
// equal ratios.
constexpr double kMinDepressionDeg = 0.6, kMaxDepressionDeg = 40;
constexpr int kDepressionBands = 14;
// Least number of samples of a cell, and of cells for a fit.
constexpr std::size_t kMinSamples = 100;
constexpr int kMinCells = 10;
// Quantile of the light of a cell that counts as its darkest ground.
constexpr double kDarkQuantile = 0.03;
// Least error of the light of the darkest ground, linear.
constexpr double kMinDarkError = 0.01;
// Relative standard deviation of the prior of the airlight.
constexpr double kAirlightPrior = 0.1;
// Standard deviation of the prior of the horizon's tilt, and the spacing of tilts, degrees.
constexpr double kTiltPriorDeg = 3, kTiltStepDeg = 0.25;
// Range of the extinctions that are tried, per km, and their ratio. A fit within kMinOverWeakest of
// either end has found no minimum.
constexpr double kMinExtinctionPerKm = 0.004, kMaxExtinctionPerKm = 4, kExtinctionRatio = 1.02;
constexpr double kMinOverWeakest = 1.2;
// Number of parts of the view, whose scatter is the error.
constexpr int kParts = 3;
// Relative error of an extinction because dark ground is not the same everywhere, nor the lens's
// fall-off known: the scatter over virtual flights (docs/calibration/air.md).
constexpr double kUnevenGroundError = 0.6;
// Largest scatter between the parts of an extinction that is returned, as a share of it.
constexpr double kMaxRelativeScatter = 0.5;

// The darkest ground of one sector at one depression. It consists of woods and shadows, which have
// nearly the same light everywhere; fields do not.
struct Cell {
  int sector = 0;
  double depression_rad = 0;
  std::array<double, 3> dark{};
  std::array<double, 3> weight{};
};

std::vector<Cell> cells_of(const std::vector<SeenLight>& ground) {
  const double low = radians(kMinDepressionDeg);
  const double step = std::log(kMaxDepressionDeg / kMinDepressionDeg) / kDepressionBands;
  struct Seen {
    double depression = 0;
    std::array<std::vector<float>, 3> light;
  };
  std::vector<Seen> all(static_cast<std::size_t>(kSectors * kDepressionBands));
  for (const SeenLight& s : ground) {
    const double at = std::log(-s.elevation_rad / low) / step;
    if (!(at >= 0 && at < kDepressionBands)) continue;
    Seen& here = all[static_cast<std::size_t>(sector_of(s.azimuth_rad) * kDepressionBands) +
                     static_cast<std::size_t>(at)];
    here.depression += -s.elevation_rad;
    for (std::size_t c = 0; c < 3; ++c) here.light[c].push_back(s.linear[c]);
  }
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::size_t count = all[i].light[0].size();
    if (count < kMinSamples) continue;
    Cell cell;
    cell.sector = static_cast<int>(i) / kDepressionBands;
    cell.depression_rad = all[i].depression / double(count);
    for (std::size_t c = 0; c < 3; ++c) {
      cell.dark[c] = quantile(all[i].light[c], kDarkQuantile);
      // Ground that varies more within a cell also varies more between cells.
      const double spread = quantile(all[i].light[c], 3 * kDarkQuantile) - cell.dark[c];
      cell.weight[c] = 1 / (spread * spread + kMinDarkError * kMinDarkError);
    }
    cells.push_back(cell);
  }
  return cells;
}

// The weighted squared misfit of one channel under the best ground colour and airlights.
double misfit(const std::vector<Cell>& cells,
              std::size_t c,
              const SkyCurves& sky,
              double metres,
              double tilt_rad,
              double beta_per_km) {
  // The airlights are eliminated one by one, since each occurs only in the cells of its own sector.
  struct Sector {
    double aa = 0, ag = 0, ay = 0;
  };
  std::array<Sector, kSectors> sectors;
  double gg = 0, gy = 0, yy = 0;
  for (const Cell& cell : cells) {
    const double depression = std::max(cell.depression_rad + tilt_rad, 2e-3);
    const double t = std::exp(-beta_per_km * 1e-3 * metres / std::sin(depression));
    const double w = cell.weight[c];
    const double y = cell.dark[c];
    Sector& s = sectors[static_cast<std::size_t>(cell.sector)];
    s.aa += w * (1 - t) * (1 - t), s.ag += w * (1 - t) * t, s.ay += w * (1 - t) * y;
    gg += w * t * t, gy += w * t * y, yy += w * y * y;
  }
  for (std::size_t i = 0; i < sectors.size(); ++i) {
    Sector s = sectors[i];
    if (!sky[i] || s.aa == 0) continue;
    const double a = sky[i]->at(c, tilt_rad);
    const double trust = 1 / (kAirlightPrior * a * kAirlightPrior * a);
    s.aa += trust, s.ay += trust * a, yy += trust * a * a;
    gg -= s.ag * s.ag / s.aa, gy -= s.ag * s.ay / s.aa, yy -= s.ay * s.ay / s.aa;
  }
  return yy - gy * gy / std::max(gg, 1e-12);
}

// The extinction of one channel at one tilt, per km, and the misfit. The error is the change at
// which the misfit has grown by the mean misfit per cell.
struct ChannelFit {
  Estimate beta;
  double misfit = 1e300;
};

ChannelFit fit_channel(const std::vector<Cell>& cells,
                       std::size_t c,
                       const SkyCurves& sky,
                       double altitude_m,
                       double tilt_rad,
                       double freedom) {
  ChannelFit best;
  std::vector<std::pair<double, double>> curve;
  for (double beta = kMinExtinctionPerKm; beta < kMaxExtinctionPerKm; beta *= kExtinctionRatio) {
    const double m = misfit(cells, c, sky, altitude_m, tilt_rad, beta);
    curve.push_back({beta, m});
    if (m < best.misfit) best.misfit = m, best.beta.value = beta;
  }
  double low = best.beta.value, high = low;
  for (const auto& [beta, m] : curve)
    if (m <= best.misfit * (1 + 1 / freedom))
      low = std::min(low, beta), high = std::max(high, beta);
  best.beta.sigma = (high - low) / 2;
  return best;
}

Fading fit(const std::vector<Cell>& cells, const SkyCurves& sky, double altitude_m) {
  // Keeps the logarithm of a perfect fit finite.
  constexpr double kMinMisfit = 1e-12;
  const double freedom = std::max(1.0, double(cells.size()) - 4);
  Fading best;
  double best_total = 1e300;
  for (double tilt_deg = -2 * kTiltPriorDeg; tilt_deg < 2.01 * kTiltPriorDeg;
       tilt_deg += kTiltStepDeg) {
    Fading at;
    at.horizon_rad = radians(tilt_deg);
    double total = tilt_deg * tilt_deg / (kTiltPriorDeg * kTiltPriorDeg);
    for (std::size_t c = 0; c < 3; ++c) {
      const ChannelFit found = fit_channel(cells, c, sky, altitude_m, at.horizon_rad, freedom);
      at.extinction_per_km[c] = found.beta;
      total += freedom * std::log(std::max(found.misfit, kMinMisfit));
    }
    if (total < best_total) best_total = total, best = at;
  }
  return best;
}

// Separate fits to parts of the view, each with its own fields and woods.
std::vector<Fading> fits_of_parts(const std::vector<Cell>& cells,
                                  const SkyCurves& sky,
                                  double altitude_m) {
  std::vector<Fading> parts;
  for (int part = 0; part < kParts; ++part) {
    std::vector<Cell> some;
    for (const Cell& cell : cells)
      if (cell.sector % kParts == part) some.push_back(cell);
    if (some.size() >= kMinCells / kParts) parts.push_back(fit(some, sky, altitude_m));
  }
  return parts;
}

// The colour channel from which the visibility follows: the one nearest to the eye's sensitivity.
constexpr std::size_t kGreen = 1;

// The visibility compares near ground, below the horizon by more than the first angle, with far
// ground, below it by less than the second (extinction.h).
constexpr double kNearDepressionDeg = 10, kFarDepressionDeg = 5;

// The light of the darkest ground near the camera; empty if none is seen.
std::optional<double> dark_near_ground(const std::vector<Cell>& cells) {
  std::vector<double> near;
  for (const Cell& cell : cells)
    if (cell.depression_rad > radians(kNearDepressionDeg)) near.push_back(cell.dark[kGreen]);
  if (near.empty()) return std::nullopt;
  return median(std::move(near));
}

// The largest extinction, per km, that the darkest far ground of each cell supports.
std::vector<float> largest_extinctions_per_km(const std::vector<Cell>& cells,
                                              const SkyCurves& sky,
                                              double dark,
                                              double altitude_m) {
  // Least contrast between near ground and sky, linear light.
  constexpr double kMinContrast = 0.02;
  // Least share of that contrast that is kept: less is not distinguishable from none.
  constexpr double kMinShare = 1e-3;
  std::vector<float> per_km;
  for (const Cell& cell : cells) {
    const auto& curve = sky[static_cast<std::size_t>(cell.sector)];
    if (!curve || cell.depression_rad > radians(kFarDepressionDeg)) continue;
    const double contrast = curve->at(kGreen, 0) - dark;
    if (contrast < kMinContrast) continue;
    const double share =
        std::clamp((curve->at(kGreen, 0) - cell.dark[kGreen]) / contrast, kMinShare, 1.0);
    const double range_km = 1e-3 * altitude_m / std::sin(cell.depression_rad);
    per_km.push_back(static_cast<float>(-std::log(share) / range_km));
  }
  return per_km;
}

}  // namespace

Measured<Fading> fading_of_ground(const std::vector<SeenLight>& ground,
                                  const SkyCurves& sky,
                                  double altitude_m) {
  std::vector<Cell> cells = cells_of(ground);
  std::erase_if(cells, [&](const Cell& c) { return !sky[static_cast<std::size_t>(c.sector)]; });
  if (cells.size() < kMinCells)
    return NotMeasured{"too little ground is seen at different distances"};
  Fading all = fit(cells, sky, altitude_m);
  const std::vector<Fading> parts = fits_of_parts(cells, sky, altitude_m);
  for (std::size_t c = 0; c < 3; ++c) {
    auto& [beta, sigma] = all.extinction_per_km[c];
    double squares = 0;
    for (const Fading& part : parts) {
      const double off = part.extinction_per_km[c].value - beta;
      squares += off * off;
    }
    const double n = std::max<double>(2, double(parts.size()));
    const double scatter = std::max(sigma, std::sqrt(squares / (n * (n - 1))));
    sigma = std::hypot(scatter, kUnevenGroundError * beta);
    if (beta < kMinOverWeakest * kMinExtinctionPerKm ||
        beta > kMaxExtinctionPerKm / kMinOverWeakest || scatter > kMaxRelativeScatter * beta)
      return NotMeasured{"the ground's colour does not go over into the airlight clearly enough"};
  }
  return all;
}

std::optional<double> visibility_by_horizon_km(const std::vector<SeenLight>& ground,
                                               const SkyCurves& sky,
                                               double altitude_m) {
  // Share of the values that lie below the one that is used.
  constexpr double kQuantile = 0.25;
  // Least number of cells with a value.
  constexpr std::size_t kMinValues = 3;
  // Keeps the visibility of air without extinction finite.
  constexpr double kMinPerKm = 1e-6;
  const std::vector<Cell> cells = cells_of(ground);
  const auto dark = dark_near_ground(cells);
  if (!dark) return std::nullopt;
  std::vector<float> per_km = largest_extinctions_per_km(cells, sky, *dark, altitude_m);
  if (per_km.size() < kMinValues) return std::nullopt;
  const double visibility_km =
      kKoschmieder / std::max<double>(quantile(per_km, kQuantile), kMinPerKm);
  for (const double class_km : kVisibilityClassesKm)
    if (visibility_km <= class_km) return class_km;
  return kVisibilityClassesKm.back();
}

}  // namespace airtruth::air
