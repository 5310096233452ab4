// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "foundation/geometry/transform.h"
#include "foundation/image/colour.h"
#include "measure/measured/estimate.h"

namespace airtruth::calibration {

// One estimate per channel: red, green, blue of linear light.
using ColourEstimate = std::array<Estimate, 3>;

// The number of equal sectors into which azimuth is divided. Each sector has its own airlight,
// since airlight is brighter towards the sun.
constexpr int kSectors = 12;

// Light that arrives from one direction of a level world.
struct SeenLight {
  double azimuth_rad = 0;
  double elevation_rad = 0;  // negative below the horizon
  image::Rgb linear;
};
// `direction_in_level`: unit vector in a level frame with z down.
SeenLight seen_under(const Vector3& direction_in_level, const image::Rgb& linear);
// The sector of an azimuth, 0 to kSectors - 1.
int sector_of(double azimuth_rad);

// The light of the sky as a function of elevation, in one sector. Extrapolated to the horizon,
// where hills may hide the sky, it is the light of an infinitely long path through air. The curve
// is a parabola, fitted by least squares to the medians of the light between two elevations.
struct SkyCurve {
  // For each channel: the coefficients of (elevation / 10 degrees) to the powers 0, 1 and 2.
  std::array<std::array<double, 3>, 3> by_channel{};
  // For each channel: standard error at the horizon.
  std::array<double, 3> sigma{};
  double at(std::size_t channel, double elevation_rad) const;
};
// One curve per sector; empty where too little sky is seen between the two elevations.
using SkyCurves = std::array<std::optional<SkyCurve>, kSectors>;
// The range of elevations, degrees, in which the sky is used.
struct SkyReach {
  double low_deg = 2, high_deg = 10;
};
SkyCurves sky_curves(const std::vector<SeenLight>& seen, const SkyReach& reach = {});

// The mean of the curves at an elevation; empty if no sector has a curve.
std::optional<ColourEstimate> airlight_of(const SkyCurves& sky, double elevation_rad);

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
// with 15 % of the value for ground that is not equally dark everywhere. Empty, with the reason in
// `why`, where the ground does not fade clearly.
struct Fading {
  ColourEstimate extinction_per_km;
  // Elevation of the true horizon, on the scale of SeenLight::elevation_rad.
  double horizon_rad = 0;
};
std::optional<Fading> fading_of_ground(const std::vector<SeenLight>& ground,
                                       const SkyCurves& sky,
                                       double altitude_m,
                                       std::string& why);

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

}  // namespace airtruth::calibration
