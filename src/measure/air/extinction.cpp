// SPDX-License-Identifier: Apache-2.0
#include "measure/air/extinction.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <Eigen/Cholesky>

#include "foundation/base/median.h"

namespace airtruth::calibration {
namespace {

constexpr double kSkyUnitDeg = 10;
constexpr int kSkyBands = 16;
constexpr std::size_t kFewestInBand = 20;
constexpr int kFewestBands = 6;

constexpr double kLeastDepressionDeg = 0.6;
constexpr double kMostDepressionDeg = 40;
constexpr int kGroundBands = 14;
constexpr std::size_t kFewestInCell = 100;
constexpr int kFewestCells = 10;
// Relative standard deviation of the prior of the airlight.
constexpr double kAirlightTrust = 0.1;
// Quantile of the light of a cell that counts as its darkest ground.
constexpr double kDark = 0.03;
constexpr double kLeastDarkSpread = 0.01;
constexpr double kTiltTrustDeg = 3;
constexpr double kTiltStepDeg = 0.25;
// Range of the extinctions that are tried, per km.
constexpr double kWeakest = 0.004;
constexpr double kStrongest = 4;
constexpr double kStep = 1.02;
constexpr int kParts = 3;
// Relative error that is added because dark ground is not the same everywhere.
constexpr double kModelError = 0.15;
// Largest relative error of an extinction that is returned.
constexpr double kLeastKnown = 0.5;

// The darkest ground of one sector at one depression. It consists of woods and shadows, which have
// nearly the same light everywhere; fields do not.
struct Cell {
  int sector = 0;
  double depression_rad = 0;
  std::array<double, 3> dark{};
  std::array<double, 3> weight{};
};

double quantile(std::vector<float>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return double(*at);
}

std::vector<Cell> cells_of(const std::vector<SeenLight>& ground) {
  const double low = radians(kLeastDepressionDeg);
  const double step = std::log(kMostDepressionDeg / kLeastDepressionDeg) / kGroundBands;
  struct Seen {
    double depression = 0;
    std::array<std::vector<float>, 3> light;
  };
  std::vector<Seen> all(static_cast<std::size_t>(kSectors * kGroundBands));
  for (const SeenLight& s : ground) {
    const double at = std::log(-s.elevation_rad / low) / step;
    if (!(at >= 0 && at < kGroundBands)) continue;
    Seen& here = all[static_cast<std::size_t>(sector_of(s.azimuth_rad) * kGroundBands) +
                     static_cast<std::size_t>(at)];
    here.depression += -s.elevation_rad;
    for (std::size_t c = 0; c < 3; ++c) here.light[c].push_back(s.linear[c]);
  }
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::size_t count = all[i].light[0].size();
    if (count < kFewestInCell) continue;
    Cell cell;
    cell.sector = static_cast<int>(i) / kGroundBands;
    cell.depression_rad = all[i].depression / double(count);
    for (std::size_t c = 0; c < 3; ++c) {
      cell.dark[c] = quantile(all[i].light[c], kDark);
      // Ground that varies more within a cell also varies more between cells.
      const double spread = quantile(all[i].light[c], 3 * kDark) - cell.dark[c];
      cell.weight[c] = 1 / (spread * spread + kLeastDarkSpread * kLeastDarkSpread);
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
    const double trust = 1 / (kAirlightTrust * a * kAirlightTrust * a);
    s.aa += trust, s.ay += trust * a, yy += trust * a * a;
    gg -= s.ag * s.ag / s.aa, gy -= s.ag * s.ay / s.aa, yy -= s.ay * s.ay / s.aa;
  }
  return yy - gy * gy / std::max(gg, 1e-12);
}

struct Fit {
  // Extinction of each channel, per km.
  std::array<double, 3> beta{};
  double tilt_rad = 0;
  // Error: the change at which the misfit has grown by the mean misfit per cell.
  std::array<double, 3> sigma{};
};

Fit fit(const std::vector<Cell>& cells, const SkyCurves& sky, double altitude_m) {
  const double free = std::max(1.0, double(cells.size()) - 4);
  Fit best;
  double best_total = 1e300;
  for (double tilt_deg = -2 * kTiltTrustDeg; tilt_deg < 2.01 * kTiltTrustDeg;
       tilt_deg += kTiltStepDeg) {
    Fit at;
    at.tilt_rad = radians(tilt_deg);
    double total = tilt_deg * tilt_deg / (kTiltTrustDeg * kTiltTrustDeg);
    for (std::size_t c = 0; c < 3; ++c) {
      std::vector<std::pair<double, double>> curve;
      double least = 1e300;
      for (double beta = kWeakest; beta < kStrongest; beta *= kStep) {
        const double m = misfit(cells, c, sky, altitude_m, radians(tilt_deg), beta);
        curve.push_back({beta, m});
        if (m < least) least = m, at.beta[c] = beta;
      }
      double low = at.beta[c], high = at.beta[c];
      for (const auto& [beta, m] : curve)
        if (m <= least * (1 + 1 / free)) low = std::min(low, beta), high = std::max(high, beta);
      at.sigma[c] = (high - low) / 2;
      total += free * std::log(std::max(least, 1e-12));
    }
    if (total < best_total) best_total = total, best = at;
  }
  return best;
}

}  // namespace

SeenLight seen_under(const Vector3& direction, const image::Rgb& linear) {
  return {std::atan2(direction.y(), direction.x()),
          std::asin(std::clamp(-direction.z(), -1.0, 1.0)),
          linear};
}

int sector_of(double azimuth_rad) {
  const double turn = azimuth_rad / (2 * kPi) - std::floor(azimuth_rad / (2 * kPi));
  return std::min(kSectors - 1, static_cast<int>(turn * kSectors));
}

double SkyCurve::at(std::size_t channel, double elevation_rad) const {
  const double x = elevation_rad / radians(kSkyUnitDeg);
  const auto& p = by_channel[channel];
  return std::clamp(p[0] + x * (p[1] + x * p[2]), 0.01, 1.5);
}

SkyCurves sky_curves(const std::vector<SeenLight>& seen, const SkyReach& reach) {
  std::vector<std::array<std::vector<double>, 3>> bands(
      static_cast<std::size_t>(kSectors * kSkyBands));
  const double low = radians(reach.low_deg);
  const double span = radians(reach.high_deg) - low;
  for (const SeenLight& s : seen) {
    const double at = (s.elevation_rad - low) / span * kSkyBands;
    if (!(at >= 0 && at < kSkyBands)) continue;
    auto& band = bands[static_cast<std::size_t>(sector_of(s.azimuth_rad) * kSkyBands) +
                       static_cast<std::size_t>(at)];
    for (std::size_t c = 0; c < 3; ++c) band[c].push_back(double(s.linear[c]));
  }
  SkyCurves result;
  for (int sector = 0; sector < kSectors; ++sector) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    // One column per channel.
    Eigen::Matrix3d right = Eigen::Matrix3d::Zero();
    Eigen::Vector3d squares = Eigen::Vector3d::Zero();
    int count = 0;
    for (int i = 0; i < kSkyBands; ++i) {
      const auto& band = bands[static_cast<std::size_t>(sector * kSkyBands + i)];
      if (band[0].size() < kFewestInBand) continue;
      ++count;
      const double x = (low + (i + 0.5) / kSkyBands * span) / radians(kSkyUnitDeg);
      const Eigen::Vector3d row(1, x, x * x);
      Eigen::RowVector3d middle;
      for (int c = 0; c < 3; ++c) middle[c] = median(band[static_cast<std::size_t>(c)]);
      normal += row * row.transpose();
      right += row * middle;
      squares += middle.cwiseAbs2().transpose();
    }
    if (count < kFewestBands) continue;
    const auto solver = normal.ldlt();
    const Eigen::Matrix3d solution = solver.solve(right);
    const Eigen::Matrix3d inverse = solver.solve(Eigen::Matrix3d::Identity());
    SkyCurve curve;
    for (int c = 0; c < 3; ++c) {
      const double rest = std::max(0.0, squares[c] - solution.col(c).dot(right.col(c)));
      const auto channel = static_cast<std::size_t>(c);
      curve.by_channel[channel] = {solution(0, c), solution(1, c), solution(2, c)};
      curve.sigma[channel] = std::sqrt(rest / (count - 3 + 1) * inverse(0, 0));
    }
    result[static_cast<std::size_t>(sector)] = curve;
  }
  return result;
}

std::optional<ColourEstimate> airlight_of(const SkyCurves& sky, double elevation_rad) {
  ColourEstimate mean;
  int count = 0;
  for (const auto& sector : sky) {
    if (!sector) continue;
    ++count;
    for (std::size_t c = 0; c < 3; ++c) {
      mean[c].value += sector->at(c, elevation_rad);
      mean[c].sigma = std::hypot(mean[c].sigma, sector->sigma[c]);
    }
  }
  if (count == 0) return std::nullopt;
  for (Estimate& e : mean) e = {e.value / count, e.sigma / count};
  return mean;
}

std::optional<Fading> fading_of_ground(const std::vector<SeenLight>& ground,
                                       const SkyCurves& sky,
                                       double altitude_m,
                                       std::string& why) {
  std::vector<Cell> cells = cells_of(ground);
  std::erase_if(cells, [&](const Cell& c) { return !sky[static_cast<std::size_t>(c.sector)]; });
  if (cells.size() < kFewestCells) {
    why = "too little ground is seen at different distances";
    return std::nullopt;
  }
  const Fit all = fit(cells, sky, altitude_m);
  // The error comes from separate fits to parts of the view, each with its own fields and woods.
  std::vector<Fit> parts;
  for (int part = 0; part < kParts; ++part) {
    std::vector<Cell> some;
    std::copy_if(cells.begin(), cells.end(), std::back_inserter(some), [&](const Cell& c) {
      return c.sector % kParts == part;
    });
    if (some.size() >= kFewestCells / kParts) parts.push_back(fit(some, sky, altitude_m));
  }
  Fading result;
  result.horizon_rad = all.tilt_rad;
  for (std::size_t c = 0; c < 3; ++c) {
    double squares = 0;
    for (const Fit& p : parts) squares += (p.beta[c] - all.beta[c]) * (p.beta[c] - all.beta[c]);
    const double n = std::max<double>(2, double(parts.size()));
    const double scatter = std::max(all.sigma[c], std::sqrt(squares / (n * (n - 1))));
    const double sigma = std::hypot(scatter, kModelError * all.beta[c]);
    if (all.beta[c] < 1.2 * kWeakest || all.beta[c] > kStrongest / 1.2 ||
        sigma > kLeastKnown * all.beta[c]) {
      why = "the ground's colour does not go over into the airlight clearly enough";
      return std::nullopt;
    }
    result.extinction_per_km[c] = {all.beta[c], sigma};
  }
  return result;
}

std::optional<double> visibility_by_horizon_km(const std::vector<SeenLight>& ground,
                                               const SkyCurves& sky,
                                               double altitude_m) {
  constexpr double kFarDeg = 5, kNearDeg = 10;
  // Least contrast between near ground and sky, linear light.
  constexpr double kLeastContrast = 0.02;
  // Share of the values that lie below the one that is used.
  constexpr double kClearerShare = 0.25;
  constexpr std::size_t kGreen = 1;
  // -ln(0.02): Koschmieder's visibility is the range at which 2 % of the contrast remain.
  constexpr double kSeen = 3.912;
  const std::vector<Cell> cells = cells_of(ground);
  std::vector<double> near;
  for (const Cell& cell : cells)
    if (cell.depression_rad > radians(kNearDeg)) near.push_back(cell.dark[kGreen]);
  if (near.empty()) return std::nullopt;
  const double dark = median(std::move(near));
  std::vector<float> per_km;
  for (const Cell& cell : cells) {
    const auto& curve = sky[static_cast<std::size_t>(cell.sector)];
    if (!curve || cell.depression_rad > radians(kFarDeg)) continue;
    const double contrast = curve->at(kGreen, 0) - dark;
    if (contrast < kLeastContrast) continue;
    const double share =
        std::clamp((curve->at(kGreen, 0) - cell.dark[kGreen]) / contrast, 1e-3, 1.0);
    const double range_km = 1e-3 * altitude_m / std::sin(cell.depression_rad);
    per_km.push_back(static_cast<float>(-std::log(share) / range_km));
  }
  if (per_km.size() < 3) return std::nullopt;
  const double visibility_km = kSeen / std::max(quantile(per_km, kClearerShare), 1e-6);
  for (const double class_km : kVisibilityClassesKm)
    if (visibility_km <= class_km) return class_km;
  return kVisibilityClassesKm.back();
}

}  // namespace airtruth::calibration
