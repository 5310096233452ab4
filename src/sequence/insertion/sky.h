// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "picture/shade/light.h"

// Relative brightness of sky, sun and ground. Luminances are in kcd/m2 and illuminances in klx;
// only their ratios are used. The sky distributions are the CIE's models, the levels those of the
// IES (1984, "Recommended practice for the calculation of daylight availability").
namespace airtruth::insertion {

// Illuminance by the sun's elevation; elevations below 1 degree count as 1 degree.
double sun_illuminance_klx(double elevation_deg);        // square to the sun, clear sky
double clear_sky_illuminance_klx(double elevation_deg);  // level surface, without the sun

// Skies as environments, black below the horizon, each of irradiance over pi 1 on a level surface.
struct Skies {
  shade::Environment clear;
  shade::Environment overcast;
  shade::Environment ground;  // radiance 1 from all below the horizon
  Vector3 to_sun{0, 0, -1};   // unit, in world axes
  double clear_zenith = 1;    // the clear sky's luminance at the zenith, in the model's unit
  // Irradiance over pi on a level surface of a sky whose luminance at the zenith is 1.
  double clear_level = 1;
  double overcast_level = 1;

  // The luminance that a camera sees in a direction (unit, in world axes), in the environments'
  // unit. A direction below 3 degrees of elevation counts as 3 degrees, one within 20 degrees of
  // the sun as 20 degrees from it: nearer the horizon and the sun the models are steep, and where
  // both are is not known as well.
  double clear_seen(const Vector3& direction_in_world) const;
  double overcast_seen(const Vector3& direction_in_world) const;
};
Skies skies(const Vector3& to_sun_in_world);

}  // namespace airtruth::insertion
