// SPDX-License-Identifier: Apache-2.0
#include "calibration/air/air.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

namespace airtruth::air {
namespace {

// The grid of pixels at which the sky is sampled: first pixel and spacing, px. It bounds the time.
constexpr int kFirstSky = 1, kSkyStep = 6;
// Least elevation of the sky that is used for the sun; below it, haze is brighter than sky.
constexpr double kMinSunSkyDeg = 2.5;
// Elevations of the sky, degrees, that are used if the true horizon is known.
constexpr SkyReach kOverTrueHorizon{0.6, 6};
// Every kSunStep-th sample of the sky is used for the sun. It bounds the time.
constexpr std::size_t kSunStep = 3;

// Where a constant of the sun states no origin, it was chosen on the virtual flights of
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
constexpr double kMinSpreadDeg = 10, kMaxSpreadDeg = 45;
// Least ratio between the greatest and the least cost. Where the sun is out of the picture, the
// bright edge of a bank of clouds is found in its place, with a ratio of up to 1.5.
constexpr double kMinCostRatio = 1.6;

struct SkySample {
  Vector3 direction;  // unit vector, north-east-down
  double light = 0;   // luminance, linear
};

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

Measured<Sun> sun_of(const std::vector<SkySample>& sky) {
  if (sky.size() < kMinSkySamples) return NotMeasured{"too little sky is seen"};
  const std::size_t stride = std::max<std::size_t>(1, sky.size() / kFittedSamples);
  std::vector<SkySample> samples;
  for (std::size_t i = 0; i < sky.size(); i += stride) samples.push_back(sky[i]);
  Search search = over_grid(samples);
  if (search.all.empty()) return NotMeasured{"the sky is brightest nowhere"};
  refine(search, samples);
  const double spread = spread_deg(search);
  if (search.greatest < kMinCostRatio * search.least)
    return NotMeasured{"no direction explains the sky much better than others"};
  if (spread > kMaxSpreadDeg)
    return NotMeasured{"the sky does not say where it is (it would be known to " +
                       std::to_string(static_cast<int>(spread)) + " degrees)"};
  const double azimuth = search.best.azimuth_deg;
  const double turn = azimuth > 180 ? azimuth - 360 : azimuth < -180 ? azimuth + 360 : azimuth;
  return Sun{{turn, spread / 2}, {search.best.elevation_deg, spread / 2}};
}

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
    if (direction.z() > std::sin(radians(kMaxTiltDeg))) continue;
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

Air AirMeter::air(const std::stop_token& stop) const {
  const SkyCurves sky = sky_curves(sky_light(Quaternion::Identity()));
  const auto airlight = airlight_of(sky, 0);
  if (!airlight) {
    const std::string why = "no horizon is found, and so no sky just above it";
    return {NotMeasured{why},
            NotMeasured{ground_.altitude_m ? why : why + "; and " + ground_.why_unknown},
            std::nullopt};
  }
  const double height_m = ground_.altitude_m.value_or(kAssumedHeightM);
  if (ground_.altitude_m)
    if (const auto again = seen_again(stop))
      return {again->airlight, again->extinction_per_km, std::nullopt};
  const std::vector<SeenLight> ground = ground_patches(scenery(), height_m, tone_);
  const auto visibility_km = [&] { return visibility_by_horizon_km(ground, sky, height_m); };
  if (!ground_.altitude_m) return {*airlight, NotMeasured{ground_.why_unknown}, visibility_km()};
  const auto fading = fading_of_ground(ground, sky, height_m);
  if (!fading) return {*airlight, NotMeasured{fading.why()}, visibility_km()};
  return {*airlight_of(sky, fading->horizon_rad), fading->extinction_per_km, std::nullopt};
}

std::optional<SeenAgain> AirMeter::seen_again(const std::stop_token& stop) const {
  const auto track = track_ground(scenery(), stop);
  if (!track) return std::nullopt;
  return fading_of_same_ground(ground_seen(scenery(), *track, tone_),
                               sky_curves(sky_light(track->level_from_world), kOverTrueHorizon),
                               *ground_.altitude_m);
}

Measured<Sun> AirMeter::sun() const {
  const double lowest = std::sin(radians(kMinSunSkyDeg));
  std::vector<SkySample> sky;
  for (std::size_t i = 0, above = 0; i < glimpses_.size(); ++i) {
    const auto& [direction, linear] = glimpses_[i];
    if (!(-direction.z() > lowest) || ++above % kSunStep != 0) continue;
    // Luminance of Rec. 709 primaries (ITU-R BT.709).
    sky.push_back(
        {direction,
         0.2126 * double(linear[0]) + 0.7152 * double(linear[1]) + 0.0722 * double(linear[2])});
  }
  return sun_of(sky);
}

}  // namespace airtruth::air
