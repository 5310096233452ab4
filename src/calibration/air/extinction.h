// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calibration/air/sky_curve.h"
#include "calibration/measured/measured.h"

namespace airtruth::air {

// Extinction from the fading of the darkest ground with range. The darkest ground (Chavez 1988:
// woods and shadows; here the 3 % quantile) of a sector at the range r = altitude / sin(depression)
// has, by Koschmieder (1924), the light
//
//   L(r) = A_sector + (D - A_sector) exp(-extinction r)
//
// A least-squares fit over all sectors and ranges solves, for each channel, for the extinction per
// km, the light D of the dark ground without air, and the airlights A_sector, which have the sky
// curves as prior. It also solves for the elevation of the true horizon above the one that was
// found, since haze lowers the visible horizon; the prior of that elevation is 0 +- 3 degrees. The
// error of the extinction combines the scatter between three parts of the view, each fitted alone,
// with 60 % of the value for ground that is not equally dark everywhere. Not measured
// where the ground does not fade clearly.
struct Fading {
  ColourEstimate extinction_per_km;
  // Elevation of the true horizon, on the scale of SeenLight::elevation_rad.
  double horizon_rad = 0;
};
Measured<Fading> fading_of_ground(const std::vector<SeenLight>& ground,
                                  const SkyCurves& sky,
                                  double altitude_m);

// Extinction times visibility, -ln(0.02): the visibility of Koschmieder (1924) is the range at
// which 2 % of the contrast remain.
constexpr double kKoschmieder = 3.912;

// A weak prior for clips without a measured extinction: the least visibility, in km, that the
// appearance of the horizon supports. Let A be the light of the sky at the horizon, D that of the
// darkest near ground (more than 10 degrees below the horizon) and L that of the darkest ground
// within 5 degrees of the horizon, at the range r = altitude / sin(depression). The far ground
// keeps the share t = (A - L) / (A - D) of the contrast, so the extinction is at most -ln(t) / r. A
// dark line at the horizon means clear air. Every sector and depression gives one value; the lower
// quartile of them is used. The visibility is rounded up to the next bound of the international
// visibility code (haze ends at 4 km, light haze at 10, clear air at 20, very clear air at 50;
// McCartney 1976, Optics of the Atmosphere, table 1.2), so that a doubt leads to clearer air. Empty
// where too little ground or sky is seen.
inline constexpr std::array<double, 4> kVisibilityClassesKm{4, 10, 20, 50};
std::optional<double> visibility_by_horizon_km(const std::vector<SeenLight>& ground,
                                               const SkyCurves& sky,
                                               double altitude_m);

}  // namespace airtruth::air
