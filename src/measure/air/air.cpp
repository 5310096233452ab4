// SPDX-License-Identifier: Apache-2.0
#include "measure/air/air.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "measure/air/ground_patches.h"

namespace airtruth::calibration {
namespace {

// The grid of pixels at which the sky is sampled: first pixel and spacing.
constexpr int kFirstSky = 1, kSkyStep = 6;
// Lowest elevation of the sky that is used for the sun.
constexpr double kLowestSkyDeg = 2.5;
// Elevations of the sky that are used if the true horizon is known.
constexpr SkyReach kOverTrueHorizon{0.6, 6};
constexpr std::size_t kFewest = 200;
// Every kSunStep-th sample of the sky is used for the sun.
constexpr std::size_t kSunStep = 3;

struct SkySample {
  Vector3 direction;
  double light = 0;
};

}  // namespace

AirMeter::AirMeter(const lens::Lens& lens,
                   const image::Mask* own_aircraft,
                   const GroundRange& ground,
                   const image::ToneCurve& tone)
    : lens_(lens),
      own_aircraft_(own_aircraft),
      ground_(ground),
      tone_(tone),
      sky_rays_(pixel_rays(lens, own_aircraft, kFirstSky, kSkyStep)) {}

void AirMeter::add(const image::Picture& picture, const Quaternion& cam_from_world) {
  views_.push_back({&picture, cam_from_world});
  const image::ColourCode code(picture.colour);
  const Quaternion world_from_cam = cam_from_world.conjugate();
  for (const PixelRay& ray : sky_rays_) {
    const Vector3 direction = world_from_cam * ray.in_cam;
    if (direction.z() > std::sin(radians(kMostTiltDeg))) continue;
    glimpses_.push_back({direction, image::linear_at(picture, code, ray.x, ray.y, tone_)});
  }
}

std::vector<SeenLight> AirMeter::sky_light(const Quaternion& level_from_world) const {
  std::vector<SeenLight> result;
  for (const Glimpse& g : glimpses_) {
    const Vector3 direction = level_from_world * g.direction;
    if (direction.z() < 0) result.push_back(seen_under(direction, g.linear));
  }
  return result;
}

AirMeter::Air AirMeter::air(const std::stop_token& stop) const {
  Air air;
  const SkyCurves sky = sky_curves(sky_light(Quaternion::Identity()));
  air.airlight = airlight_of(sky, 0);
  if (!air.airlight) {
    air.why = "no horizon is found, and so no sky just above it";
    air.why_no_extinction = ground_.altitude_m ? air.why : air.why + "; and " + ground_.why_unknown;
  } else if (!ground_.altitude_m) {
    air.why_no_extinction = ground_.why_unknown;
  } else if (const auto again = seen_again(stop)) {
    air.extinction_per_km = again->extinction_per_km;
    air.airlight = again->airlight;
  } else if (const auto fading = fading_of_ground(
                 ground_patches(views_, lens_, own_aircraft_, *ground_.altitude_m, tone_),
                 sky,
                 *ground_.altitude_m,
                 air.why_no_extinction)) {
    air.extinction_per_km = fading->extinction_per_km;
    air.airlight = airlight_of(sky, fading->horizon_rad);
  }
  if (air.airlight && !air.extinction_per_km) {
    const double height_m = ground_.altitude_m.value_or(kAssumedHeightM);
    air.visibility_km = visibility_by_horizon_km(
        ground_patches(views_, lens_, own_aircraft_, height_m, tone_), sky, height_m);
  }
  return air;
}

std::optional<SeenAgain> AirMeter::seen_again(const std::stop_token& stop) const {
  const auto track = track_ground(views_, lens_, own_aircraft_, stop);
  if (!track) return std::nullopt;
  return fading_of_same_ground(ground_seen(views_, *track, lens_, own_aircraft_, tone_),
                               sky_curves(sky_light(track->level_from_world), kOverTrueHorizon),
                               *ground_.altitude_m);
}

std::optional<AirMeter::Sun> AirMeter::sun(std::string& why) const {
  std::vector<SkySample> sky;
  for (std::size_t i = 0, above = 0; i < glimpses_.size(); ++i) {
    const auto& [direction, linear] = glimpses_[i];
    if (!(-direction.z() > std::sin(radians(kLowestSkyDeg))) || ++above % kSunStep != 0) continue;
    sky.push_back(
        {direction,
         0.2126 * double(linear[0]) + 0.7152 * double(linear[1]) + 0.0722 * double(linear[2])});
  }
  if (sky.size() < 10 * kFewest) {
    why = "too little sky is seen";
    return std::nullopt;
  }
  const std::size_t stride = std::max<std::size_t>(1, sky.size() / 4000);
  std::vector<SkySample> samples;
  for (std::size_t i = 0; i < sky.size(); i += stride) samples.push_back(sky[i]);
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
  // Asymmetric least squares (Newey and Powell 1987). Clouds are brighter than the sky behind them
  // and have a small weight.
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
    // A fit in which the sky is darker towards the sun is rejected.
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
  // The uncertainty: the largest angle to a direction that explains the sky nearly as well.
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
