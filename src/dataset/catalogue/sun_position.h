// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "dataset/catalogue/catalogue.h"

namespace airtruth::dataset {

struct SunPosition {
  double azimuth_deg = 0;  // from north towards east, 0 to 360
  double elevation_deg = 0;
};

// Returns the sun's position at a local solar time (at 12 h the sun is due south or north), from
// the declination of Cooper (1969), accurate to half a degree. day_of_year is 1 on the first of
// January.
SunPosition sun_position(double hour, double latitude_deg, int day_of_year);

// The hours between which the sun is at least kLowestSunDeg (degrees) above the horizon; empty on a
// day without such an hour.
constexpr double kLowestSunDeg = 3;
std::optional<Range> daylight_hours(double latitude_deg, int day_of_year);

}  // namespace airtruth::dataset
