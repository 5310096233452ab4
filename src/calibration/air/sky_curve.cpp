// SPDX-License-Identifier: Apache-2.0
#include "calibration/air/sky_curve.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "foundation/base/median.h"

namespace airtruth::air {
namespace {

// Unit of the elevation in the polynomials, degrees.
constexpr double kUnitDeg = 10;
// The constants were chosen on the virtual flights of surroundings_slow_test.cpp.
// Number of equal bands into which the elevations are divided.
constexpr int kBrightnessBands = 16;
// Least number of samples of a band, and of bands of a curve, which has three coefficients.
constexpr std::size_t kMinBandSamples = 20;
constexpr int kMinBands = 6;
// Bounds of the light of a sky, linear; an extrapolated parabola may leave them.
constexpr double kMinLight = 0.01, kMaxLight = 1.5;

// The samples of one band of one sector, by channel.
using Band = std::array<std::vector<double>, 3>;

// All bands of a sector follow one another.
std::vector<Band> bands_of(const std::vector<SeenLight>& seen, double low, double span) {
  std::vector<Band> bands(static_cast<std::size_t>(kSectors * kBrightnessBands));
  for (const SeenLight& s : seen) {
    const double at = (s.elevation_rad - low) / span * kBrightnessBands;
    if (!(at >= 0 && at < kBrightnessBands)) continue;
    Band& band = bands[static_cast<std::size_t>(sector_of(s.azimuth_rad) * kBrightnessBands) +
                       static_cast<std::size_t>(at)];
    for (std::size_t c = 0; c < 3; ++c) band[c].push_back(double(s.linear[c]));
  }
  return bands;
}

// The normal equations of the parabolas of the three channels; one column per channel.
struct Parabolas {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d right = Eigen::Matrix3d::Zero();
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  int count = 0;

  void add(double x, const Eigen::RowVector3d& light) {
    ++count;
    const Eigen::Vector3d row(1, x, x * x);
    normal += row * row.transpose();
    right += row * light;
    squares += light.cwiseAbs2().transpose();
  }
  SkyCurve curve() const {
    const auto solver = normal.ldlt();
    const Eigen::Matrix3d solution = solver.solve(right);
    const Eigen::Matrix3d inverse = solver.solve(Eigen::Matrix3d::Identity());
    SkyCurve result;
    for (int c = 0; c < 3; ++c) {
      const double rest = std::max(0.0, squares[c] - solution.col(c).dot(right.col(c)));
      const auto channel = static_cast<std::size_t>(c);
      result.by_channel[channel] = {solution(0, c), solution(1, c), solution(2, c)};
      result.sigma[channel] = std::sqrt(rest / (count - 3 + 1) * inverse(0, 0));
    }
    return result;
  }
};

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
  const double x = elevation_rad / radians(kUnitDeg);
  const auto& p = by_channel[channel];
  return std::clamp(p[0] + x * (p[1] + x * p[2]), kMinLight, kMaxLight);
}

SkyCurves sky_curves(const std::vector<SeenLight>& seen, const SkyReach& reach) {
  const double low = radians(reach.low_deg);
  const double span = radians(reach.high_deg) - low;
  const std::vector<Band> bands = bands_of(seen, low, span);
  SkyCurves result;
  for (int sector = 0; sector < kSectors; ++sector) {
    Parabolas parabolas;
    for (int i = 0; i < kBrightnessBands; ++i) {
      const Band& band = bands[static_cast<std::size_t>(sector * kBrightnessBands + i)];
      if (band[0].size() < kMinBandSamples) continue;
      Eigen::RowVector3d middle;
      for (int c = 0; c < 3; ++c) middle[c] = median(band[static_cast<std::size_t>(c)]);
      parabolas.add((low + (i + 0.5) / kBrightnessBands * span) / radians(kUnitDeg), middle);
    }
    if (parabolas.count >= kMinBands) result[static_cast<std::size_t>(sector)] = parabolas.curve();
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

}  // namespace airtruth::air
