// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "calibration/air/extinction.h"
#include "calibration/air/ground_seen.h"
#include "calibration/air/ground_track.h"
#include "calibration/air/same_ground.h"
#include "calibration/air/sky_curve.h"
#include "calibration/measured/measured.h"
#include "camera/lens/lens.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "foundation/image/tone_curve.h"

namespace airtruth::air {

// The height from which the range of a ground point follows: a known lens gives the direction of a
// pixel, and the altitude above level ground gives the range along that direction.
struct GroundRange {
  // Height of the camera above the ground, metres.
  std::optional<double> altitude_m;
  // If `altitude_m` is empty: the input that is missing, for messages.
  std::string why_unknown;
};

// Height in metres that is assumed for the visibility when the altitude is unknown. Nearly all
// aerial footage is filmed from lower. From a lower camera the same appearance of the horizon means
// thicker air, so the assumption errs towards clear air.
inline constexpr double kAssumedHeightM = 1000;

struct Air {
  // Airlight at the horizon: that of the sky, or the one fitted together with the extinction.
  Measured<ColourEstimate> airlight;
  // It comes from ground that is seen again at a shorter range (same_ground.h); if that fails, from
  // the fading of the darkest ground with range (extinction.h). Not measured without an altitude
  // and where neither method finds an answer.
  Measured<ColourEstimate> extinction_per_km;
  // The least visibility in km that the appearance of the horizon supports (extinction.h). It is
  // given only where a horizon is found and the extinction is not measured. Without an altitude the
  // camera is assumed to fly at kAssumedHeightM.
  std::optional<double> visibility_km;
};

// Direction of the sun, degrees: the azimuth from the world's north, -180 to 180, and the elevation
// above the horizon, 1 to 89.
struct Sun {
  Estimate azimuth_deg, elevation_deg;
};

// Measures airlight, extinction and the direction of the sun from the light above and below the
// horizon. Light is linear, per channel (red, green, blue). Views are added one by one; the
// measurements are made from all of them together.
class AirMeter {
 public:
  AirMeter(const lens::Lens& lens,
           const image::Mask* own_aircraft,
           const GroundRange& ground,
           const image::ToneCurve& tone);
  // Adds one view. The world frame of `cam_from_world` is north-east-down; azimuths are relative to
  // the heading that the caller puts into it. The meter keeps a pointer to `picture`, which must
  // outlive it.
  void add(const image::Picture& picture, const Quaternion& cam_from_world);

  Air air(const std::stop_token& stop = {}) const;
  // The direction towards which the clear sky is brightest. For each direction on a grid a smooth
  // sky is fitted: a polynomial in the height, a bright horizon, and lobes about the direction.
  // Clouds are brighter than the clear sky behind them, so the fit follows the darker part of the
  // sky (asymmetric least squares, Newey and Powell 1987). The direction with the best fit is
  // refined; its error is half of the angle to the farthest direction that explains the sky nearly
  // as well.
  //
  // Not measured with fewer than 2000 samples, where no direction explains the sky much better than
  // the worst (most often the sun is then out of the picture), and where the directions that
  // explain it nearly as well span more than 45 degrees.
  Measured<Sun> sun() const;

 private:
  Scenery scenery() const { return {views_, lens_, own_aircraft_}; }
  std::optional<SeenAgain> seen_again(const std::stop_token& stop) const;
  // The samples above the horizon, rotated by `level_from_world`.
  std::vector<SeenLight> sky_light(const Quaternion& level_from_world) const;
  struct Glimpse {
    Vector3 direction;  // in the world frame of the views
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

}  // namespace airtruth::air
