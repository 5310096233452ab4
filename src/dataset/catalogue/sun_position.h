// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "dataset/catalogue/catalogue.h"

namespace airtruth::dataset {

struct SunPosition {
  double azimuth_deg = 0;  // from north towards east, 0 to 360
  double elevation_deg = 0;
};

// Where the sun stands at a local solar time (12 h: due south or north), by the declination of
// Cooper (1969), within half a degree. day_of_year: 1 is the first of January.
SunPosition sun_position(double hour, double latitude_deg, int day_of_year);

// Hours between which the sun is kLowestSunDeg or more above the horizon; empty where it never is.
constexpr double kLowestSunDeg = 3;
std::optional<Range> daylight_hours(double latitude_deg, int day_of_year);

}  // namespace airtruth::dataset
