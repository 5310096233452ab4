// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "camera/horizon/horizon.h"
#include "measure/calibration/calibration.h"
#include "measure/calibration/extinction.h"
#include "measure/calibration/ground_track.h"
#include "measure/calibration/rays.h"
#include "measure/calibration/same_ground.h"

namespace airtruth::calibration {

// What gives a point of the ground its range: the camera's height above it, through a lens that is
// known.
struct GroundRange {
  std::optional<double> altitude_m;
  std::string why_unknown;  // where it is empty: what is missing
};

// Air and sun from the colours above and below the horizon.
class AirMeter {
 public:
  AirMeter(const lens::Lens& lens,
           const image::Mask* own_aircraft,
           const GroundRange& ground,
           const image::ToneCurve& tone);
  // cam_from_world: north-east-down, with the heading that the caller knows. The picture must
  // outlive the meter.
  void add(const image::Picture& picture, const Quaternion& cam_from_world);

  // Higher than nearly all that is filmed from the air: from lower down the same look of a horizon
  // comes of thicker air, so that this errs to clear air.
  static constexpr double kAssumedHeightM = 1000;
  struct Air {
    std::optional<ColourEstimate> airlight;  // at the horizon: of sky, or of what hazes the ground
    // Per km: from ground that is seen again from nearer (same_ground.h), else from how the darkest
    // ground fades (extinction.h). Empty without an altitude, or where it does not show.
    std::optional<ColourEstimate> extinction_per_km;
    std::string why, why_no_extinction;  // of what is empty
    // Where there is no extinction but a horizon: the visibility that its look supports, km
    // (extinction.h). Without an altitude the camera is taken to fly kAssumedHeightM high.
    std::optional<double> visibility_km;
  };
  Air air(const std::stop_token& stop = {}) const;
  // The sun's azimuth and elevation, degrees: the direction about which the clear sky (its darkest
  // part at each elevation) is brightest.
  struct Sun {
    Estimate azimuth_deg, elevation_deg;
  };
  std::optional<Sun> sun(std::string& why) const;

 private:
  std::optional<SeenAgain> seen_again(const std::stop_token& stop) const;
  // What was seen near the horizon and above, turned by that.
  std::vector<SeenLight> sky_light(const Quaternion& level_from_world) const;
  struct Glimpse {
    Vector3 direction;  // in the world of the views
    image::Rgb linear;
  };
  lens::Lens lens_;
  const image::Mask* own_aircraft_;
  GroundRange ground_;
  image::ToneCurve tone_;
  std::vector<PixelRay> sky_rays_;
  std::vector<GroundView> views_;
  std::vector<Glimpse> glimpses_;
};

}  // namespace airtruth::calibration
