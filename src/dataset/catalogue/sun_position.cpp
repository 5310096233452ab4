// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/sun_position.h"

#include <algorithm>
#include <cmath>

#include "foundation/geometry/transform.h"

namespace airtruth::dataset {
namespace {

constexpr double kObliquityDeg = 23.45;
constexpr double kDegreesPerHour = 15;

// P. I. Cooper, The absorption of radiation in solar stills, Solar Energy 12 (1969).
double declination_rad(int day_of_year) {
  return radians(kObliquityDeg * std::sin(radians(360.0 * (284 + day_of_year) / 365)));
}

}  // namespace

SunPosition sun_position(double hour, double latitude_deg, int day_of_year) {
  const double declination = declination_rad(day_of_year);
  const double latitude = radians(latitude_deg);
  const double turn = radians(kDegreesPerHour * (hour - 12));
  // The sun's direction in axes east, north, up.
  const double east = -std::cos(declination) * std::sin(turn);
  const double north = std::cos(latitude) * std::sin(declination) -
                       std::sin(latitude) * std::cos(declination) * std::cos(turn);
  const double up = std::sin(latitude) * std::sin(declination) +
                    std::cos(latitude) * std::cos(declination) * std::cos(turn);
  const double azimuth_deg = degrees(std::atan2(east, north));
  return {azimuth_deg < 0 ? azimuth_deg + 360 : azimuth_deg,
          degrees(std::asin(std::clamp(up, -1.0, 1.0)))};
}

std::optional<Range> daylight_hours(double latitude_deg, int day_of_year) {
  const double declination = declination_rad(day_of_year);
  const double latitude = radians(latitude_deg);
  const double lowest =
      std::sin(radians(kLowestSunDeg)) - std::sin(latitude) * std::sin(declination);
  const double widest = std::cos(latitude) * std::cos(declination);
  if (lowest >= widest) return std::nullopt;  // polar night
  const double half_h =
      lowest <= -widest ? 12 : degrees(std::acos(lowest / widest)) / kDegreesPerHour;
  return Range{12 - half_h, 12 + half_h};
}

}  // namespace airtruth::dataset
