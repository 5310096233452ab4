// SPDX-License-Identifier: Apache-2.0
#include "calibration/air.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace airtruth::calibration {
namespace {

constexpr int kStep = 7;  // pixels between samples
constexpr double kLowSkyDeg = 2.5;
constexpr double kHighSkyDeg = 6;
constexpr double kLeastDepressionDeg = 1.0;
constexpr std::size_t kFewest = 200;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Median and its standard error.
Estimate middle_of(const std::vector<double>& values) {
  const double m = median(values);
  std::vector<double> off;
  for (const double v : values) off.push_back(std::abs(v - m));
  return {m, 1.4826 * median(off) * 1.25 / std::sqrt(double(values.size()))};
}

struct Bin {
  double range_km = 0;
  std::array<double, 3> light{};
  double weight = 0;
};

// Misfit of A + B exp(-beta r) with the best B; A is given.
double misfit(const std::vector<Bin>& bins, std::size_t c, double airlight, double beta) {
  double sxx = 0, sxy = 0, syy = 0;
  for (const Bin& b : bins) {
    const double x = std::exp(-beta * b.range_km);
    const double y = b.light[c] - airlight;
    sxx += b.weight * x * x, sxy += b.weight * x * y, syy += b.weight * y * y;
  }
  return syy - sxy * sxy / sxx;
}

}  // namespace

AirMeter::AirMeter(const lens::Lens& lens,
                   const image::Mask* own_aircraft,
                   std::optional<double> altitude_m)
    : lens_(lens), own_aircraft_(own_aircraft), altitude_m_(altitude_m) {}

void AirMeter::add(const image::Picture& picture, const Quaternion& cam_from_world) {
  const image::ColourCode code(picture.colour);
  const Quaternion world_from_cam = cam_from_world.conjugate();
  for (int y = kStep / 2; y < picture.height; y += kStep)
    for (int x = kStep / 2; x < picture.width; x += kStep) {
      if (own_aircraft_ != nullptr && !own_aircraft_->is_free(x, y)) continue;
      const auto ray = lens_.ray_from_pixel({x + 0.5, y + 0.5});
      if (!ray) continue;
      const Vector3 direction = world_from_cam * *ray;
      const double elevation_deg = degrees(std::asin(std::clamp(-direction.z(), -1.0, 1.0)));
      const image::Rgb linear = image::linear_at(picture, code, x, y);
      if (elevation_deg > kLowSkyDeg) {
        const double light =
            0.2126 * double(linear[0]) + 0.7152 * double(linear[1]) + 0.0722 * double(linear[2]);
        if ((x / kStep + y / kStep) % 3 == 0) sky_.push_back({direction, light});
        if (elevation_deg < kHighSkyDeg) above_.push_back(linear);
      } else if (altitude_m_ && elevation_deg < -kLeastDepressionDeg) {
        below_.push_back({*altitude_m_ / -direction.z(), linear});
      }
    }
}

std::optional<AirMeter::Colour> AirMeter::airlight(std::string& why) const {
  if (above_.size() < kFewest) {
    why = "the horizon is not seen, and so not the sky just above it";
    return std::nullopt;
  }
  Colour result;
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<double> values;
    for (const image::Rgb& rgb : above_) values.push_back(double(rgb[c]));
    result[c] = middle_of(values);
  }
  return result;
}

std::optional<AirMeter::Colour> AirMeter::extinction_per_km(std::string& why) const {
  if (!altitude_m_) {
    why = "without the camera's height above the ground (--altitude) terrain has no range";
    return std::nullopt;
  }
  std::string no_air;
  const auto air = airlight(no_air);
  if (!air) {
    why = no_air;
    return std::nullopt;
  }
  constexpr int kBins = 24;
  const double nearest_km = 2e-3 * *altitude_m_;
  const double farthest_km = 1e-3 * *altitude_m_ / std::sin(radians(kLeastDepressionDeg));
  std::vector<std::array<std::vector<double>, 3>> values(kBins);
  for (const Far& f : below_) {
    const double at = std::log(f.range_m / 1000 / nearest_km) / std::log(farthest_km / nearest_km);
    if (!(at >= 0 && at < 1)) continue;
    for (std::size_t c = 0; c < 3; ++c)
      values[static_cast<std::size_t>(at * kBins)][c].push_back(double(f.linear[c]));
  }
  std::vector<Bin> bins;
  for (int i = 0; i < kBins; ++i) {
    auto& v = values[static_cast<std::size_t>(i)];
    if (v[0].size() < 60) continue;
    Bin bin;
    bin.range_km = nearest_km * std::pow(farthest_km / nearest_km, (i + 0.5) / kBins);
    double mean_error = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      double sum = 0, squares = 0;
      for (const double x : v[c]) sum += x, squares += x * x;
      const double n = double(v[c].size());
      bin.light[c] = sum / n;
      mean_error += std::sqrt(std::max(1e-12, squares / n - bin.light[c] * bin.light[c]) / n) / 3;
    }
    bin.weight = 1 / (mean_error * mean_error + 1e-6);
    bins.push_back(bin);
  }
  if (bins.size() < 8) {
    why = "too little ground is seen at different distances";
    return std::nullopt;
  }
  Colour result;
  for (std::size_t c = 0; c < 3; ++c) {
    double best = 1e300, beta = 0;
    std::vector<std::pair<double, double>> curve;
    for (double b = 0.004; b < 4; b *= 1.02) {
      const double m = misfit(bins, c, (*air)[c].value, b);
      curve.push_back({b, m});
      if (m < best) best = m, beta = b;
    }
    // One standard error: where the misfit has grown by its own mean share of one bin.
    const double scale = best / double(bins.size() - 2);
    double low = beta, high = beta;
    for (const auto& [b, m] : curve)
      if (m <= best + scale) low = std::min(low, b), high = std::max(high, b);
    if (beta < 0.005 || beta > 3.8 || (high - low) / 2 > 0.5 * beta) {
      why = "the ground's colour does not go over into the airlight clearly enough";
      return std::nullopt;
    }
    result[c] = {beta, (high - low) / 2};
  }
  return result;
}

std::optional<AirMeter::Sun> AirMeter::sun(std::string& why) const {
  if (sky_.size() < 10 * kFewest) {
    why = "too little sky is seen";
    return std::nullopt;
  }
  const std::size_t stride = std::max<std::size_t>(1, sky_.size() / 4000);
  std::vector<SkySample> samples;
  for (std::size_t i = 0; i < sky_.size(); i += stride) samples.push_back(sky_[i]);
  using Row = Eigen::Matrix<double, 8, 1>;
  const auto basis = [](const Vector3& d, const Vector3& sun) {
    const double up = std::max(0.0, -d.z());
    const double cosine = d.dot(sun);
    const double toward = std::max(0.0, cosine);
    const double p8 = std::pow(toward, 8);
    Row row;
    row << 1, up, up * up, std::exp(-10 * up), cosine * cosine, p8, p8 * p8 * p8 * p8 * p8 * p8,
        toward * toward;
    return row;
  };
  // Asymmetric least squares (Newey and Powell 1987): clouds are brighter than the sky behind them,
  // and count little.
  constexpr double kTau = 0.12;
  const auto cost_of = [&](const Vector3& sun) {
    std::vector<Row> rows;
    for (const SkySample& s : samples) rows.push_back(basis(s.direction, sun));
    Row solution = Row::Zero();
    double cost = 0;
    for (int round = 0; round < 6; ++round) {
      Eigen::Matrix<double, 8, 8> normal = Eigen::Matrix<double, 8, 8>::Identity() * 1e-6;
      Row right = Row::Zero();
      cost = 0;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const double light = std::min(samples[i].light, 1.0);
        const double e = light - rows[i].dot(solution);
        const double w = round == 0 ? 0.5 : (e > 0 ? kTau : 1 - kTau);
        cost += w * e * e;
        normal += w * rows[i] * rows[i].transpose();
        right += w * light * rows[i];
      }
      solution = normal.ldlt().solve(right);
    }
    // A sun that darkens the sky is none.
    const double glow = solution[4] + solution[5] + solution[6] + solution[7];
    return glow > 0 ? cost : 1e300;
  };
  const auto direction = [](double azimuth_deg, double elevation_deg) {
    const double a = radians(azimuth_deg), e = radians(elevation_deg);
    return Vector3(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), -std::sin(e));
  };
  double best = 1e300, azimuth = 0, elevation = 0, worst = 0;
  std::vector<std::pair<Vector3, double>> all;
  for (double e = 5; e <= 85; e += 10)
    for (double a = -180; a < 180; a += 15 / std::cos(radians(e))) {
      const double cost = cost_of(direction(a, e));
      if (cost < 1e299) worst = std::max(worst, cost), all.push_back({direction(a, e), cost});
      if (cost < best) best = cost, azimuth = a, elevation = e;
    }
  if (best > 1e299) {
    why = "the sky is brightest nowhere";
    return std::nullopt;
  }
  for (double step = 6; step > 0.8; step *= 0.6) {
    const double a0 = azimuth, e0 = elevation;
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j) {
        const double a = a0 + i * step / std::cos(radians(e0));
        const double e = std::clamp(e0 + j * step, 1.0, 89.0);
        const double cost = cost_of(direction(a, e));
        if (cost < best) best = cost, azimuth = a, elevation = e;
      }
  }
  // How far off directions lie that explain the sky nearly as well.
  const Vector3 found = direction(azimuth, elevation);
  double spread_deg = 4;
  for (const auto& [d, cost] : all)
    if (cost < best + 0.06 * (worst - best))
      spread_deg = std::max(spread_deg, degrees(std::acos(std::clamp(d.dot(found), -1.0, 1.0))));
  if (spread_deg > 45 || worst < 1.03 * best) {
    why = "the sky does not say where it is (it would be known to " +
          std::to_string(static_cast<int>(spread_deg)) + " degrees)";
    return std::nullopt;
  }
  const double turn = azimuth > 180 ? azimuth - 360 : azimuth < -180 ? azimuth + 360 : azimuth;
  return Sun{{turn, spread_deg / 2}, {elevation, spread_deg / 2}};
}

}  // namespace airtruth::calibration
