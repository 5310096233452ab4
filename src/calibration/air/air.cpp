// SPDX-License-Identifier: Apache-2.0
#include "calibration/air/air.h"

#include <algorithm>
#include <cmath>

#include "calibration/air/ground_seen.h"

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
