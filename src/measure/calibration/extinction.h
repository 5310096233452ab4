// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "foundation/geometry/transform.h"
#include "foundation/image/colour.h"
#include "measure/calibration/calibration.h"

namespace airtruth::calibration {

using ColourEstimate = std::array<Estimate, 3>;

// Azimuth is divided, since the airlight is brighter towards the sun.
constexpr int kSectors = 12;

// Light seen under one direction of a level world.
struct SeenLight {
  double azimuth_rad = 0;
  double elevation_rad = 0;  // below 0: the ground
  image::Rgb linear;
};
SeenLight seen_under(const Vector3& direction_in_level, const image::Rgb& linear);
int sector_of(double azimuth_rad);

// What an endless way through air looks like, by sector: the sky's light between two elevations,
// drawn on to the horizon, where hills hide it (least squares of a parabola on medians). Empty
// where too little of such sky is seen.
struct SkyCurve {
  std::array<std::array<double, 3>, 3> by_channel{};  // of (elevation / 10 degrees)^0, 1, 2
  std::array<double, 3> sigma{};                      // at the horizon
  double at(std::size_t channel, double elevation_rad) const;
};
using SkyCurves = std::array<std::optional<SkyCurve>, kSectors>;
struct SkyReach {
  double low_deg = 2, high_deg = 10;
};
SkyCurves sky_curves(const std::vector<SeenLight>& seen, const SkyReach& reach = {});

// Their mean at an elevation; empty where there is none.
std::optional<ColourEstimate> airlight_of(const SkyCurves& sky, double elevation_rad);

// Per km, by Koschmieder (1924): the darkest ground (Chavez 1988: woods and shadows, here the
// quantile of 3 %) of each sector at the range r = altitude / sin(depression) looks like
//
//   L(r) = A_sector + (D - A_sector) exp(-extinction r)
//
// Least squares over all sectors and ranges, for each channel: D, the airlights (held near what the
// sky says), and how far the horizon lies over where it was found, since haze draws it down (held
// near 0 by 3 degrees), are solved with it. Its error is what thirds of the view say for
// themselves, and 15 % for ground that is not the same everywhere. Empty, with the reason in `why`,
// where the ground does not fade clearly.
struct Fading {
  ColourEstimate extinction_per_km;
  double horizon_rad = 0;  // elevation of the true horizon, as elevations are given
};
std::optional<Fading> fading_of_ground(const std::vector<SeenLight>& ground,
                                       const SkyCurves& sky,
                                       double altitude_m,
                                       std::string& why);

// A weak prior for where that is not to be had: the least visibility that the horizon's look
// supports, km. The darkest ground within 5 degrees of the horizon keeps a share
// t = (A - L) / (A - D) of the contrast that the darkest ground from near (D, below 10 degrees) has
// to the sky at the horizon (A), over r = altitude / sin(depression): at most -ln(t) / r of
// extinction. A dark line at the horizon means clear air. Three quarters of the sectors' and
// depressions' values are above the one that is taken, and the visibility is rounded up to the
// bounds of the international visibility code (haze ends at 4 km, light haze at 10, clear air at
// 20, very clear air at 50; McCartney 1976, Optics of the Atmosphere, table 1.2): in doubt the
// clearer. Empty where too little ground or sky is seen.
inline constexpr std::array<double, 4> kVisibilityClassesKm{4, 10, 20, 50};
std::optional<double> visibility_by_horizon_km(const std::vector<SeenLight>& ground,
                                               const SkyCurves& sky,
                                               double altitude_m);

}  // namespace airtruth::calibration
