// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calibration/measured/measured.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/colour.h"

// The light of the sky above the horizon, by sector of the azimuth.
namespace airtruth::air {

using measured::ColourEstimate;
using measured::Measured;
using measured::NotMeasured;

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

}  // namespace airtruth::air
