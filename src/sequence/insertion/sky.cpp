// SPDX-License-Identifier: Apache-2.0
#include "sequence/insertion/sky.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

namespace airtruth::insertion {
namespace {

using image::Rgb;
using shade::Environment;

// A lower sun counts as one at this elevation (sky.h): the illuminance divides by its sine.
constexpr double kLowestSunDeg = 1;

double sine(double elevation_deg) {
  return std::sin(radians(std::clamp(elevation_deg, kLowestSunDeg, 90.0)));
}

double sine_of_elevation(const Vector3& direction) { return std::clamp(-direction.z(), -1.0, 1.0); }

double cosine_between(const Vector3& a, const Vector3& b) {
  return std::clamp(a.dot(b), -1.0, 1.0);
}

Environment grey(const std::function<double(const Vector3&)>& radiance) {
  return Environment::of([&](const Vector3& d) {
    const auto value = static_cast<float>(radiance(d));
    return Rgb{value, value, value};
  });
}

// Irradiance over pi on a level surface.
template <typename Luminance>
double level_of(const Luminance& luminance) {
  // Numbers of directions of the sum, upwards and around.
  constexpr int kElevations = 90;
  constexpr int kAzimuths = 180;
  std::array<Eigen::Vector2d, kAzimuths> headings;
  for (int k = 0; k < kAzimuths; ++k) {
    const double azimuth = 2 * kPi * (k + 0.5) / kAzimuths;
    headings[static_cast<std::size_t>(k)] = {std::cos(azimuth), std::sin(azimuth)};
  }
  double sum = 0;
  for (int i = 0; i < kElevations; ++i) {
    const double up = (i + 0.5) / kElevations;  // sine: bands of equal solid angle
    const double level = std::sqrt(1 - up * up);
    for (const Eigen::Vector2d& heading : headings)
      sum += 2 * luminance({level * heading.x(), level * heading.y(), -up}) * up;
  }
  return sum / (kElevations * kAzimuths);
}

// Bounds of the directions in which the models are used: 3 degrees and 20 degrees (sky.h).
const double kLowestSeenSine = std::sin(radians(3));
const double kNearestSunSeenCosine = std::cos(radians(20));

// Luminance of the clear sky (Perez et al. 1993, equation 1), by the sine of the elevation and the
// cosine of the angle from the sun. The parameters are those of Preetham et al. 1999, table 2, at
// turbidity 2.5.
double perez(double sine, double cosine_from_sun) {
  constexpr double a = -1.0163, b = -0.4610, c = 5.2684, d = -2.2756, e = 0.2028;
  // The model divides by the sine, which the horizon lacks.
  constexpr double kMinSine = 0.01;
  return (1 + a * std::exp(b / std::max(kMinSine, sine))) *
         (1 + c * std::exp(d * std::acos(cosine_from_sun)) + e * cosine_from_sun * cosine_from_sun);
}

// Moon and Spencer 1942.
double overcast_at(double sine) { return (1 + 2 * sine) / 3; }

double overcast_sky(const Vector3& d) {
  return d.z() > 0 ? 0.0 : overcast_at(sine_of_elevation(d));
}

// What does not depend on the sun.
struct UnderAnySun {
  double overcast_level = level_of(overcast_sky);
  shade::Environment overcast =
      grey([&](const Vector3& d) { return overcast_sky(d) / overcast_level; });
  shade::Environment ground = grey([](const Vector3& d) { return d.z() > 0 ? 1.0 : 0.0; });
};

Skies skies_of(const Vector3& to_sun_in_world) {
  static const UnderAnySun under_any_sun;
  const double sun_elevation_deg = degrees(std::asin(sine_of_elevation(to_sun_in_world)));
  const double zenith = perez(1, sine(sun_elevation_deg));
  const auto clear = [&](const Vector3& d) {
    if (d.z() > 0) return 0.0;
    return perez(sine_of_elevation(d), cosine_between(d, to_sun_in_world)) / zenith;
  };
  Skies result;
  result.to_sun = to_sun_in_world;
  result.clear_zenith = zenith;
  result.clear_level = level_of(clear);
  result.overcast_level = under_any_sun.overcast_level;
  result.clear = grey([&](const Vector3& d) { return clear(d) / result.clear_level; });
  result.overcast = under_any_sun.overcast;
  result.ground = under_any_sun.ground;
  return result;
}

}  // namespace

double sun_illuminance_klx(double elevation_deg) {
  return 127.5 * std::exp(-0.21 / sine(elevation_deg));
}

double clear_sky_illuminance_klx(double elevation_deg) {
  return 0.8 + 15.5 * std::sqrt(sine(elevation_deg));
}

Skies skies(const Vector3& to_sun_in_world) {
  // Scenes one after the other often have one sun.
  thread_local std::optional<Skies> last;
  if (!last || last->to_sun != to_sun_in_world) last = skies_of(to_sun_in_world);
  return *last;
}

double Skies::clear_seen(const Vector3& direction_in_world) const {
  return perez(std::max(kLowestSeenSine, sine_of_elevation(direction_in_world)),
               std::min(kNearestSunSeenCosine, cosine_between(direction_in_world, to_sun))) /
         clear_zenith / clear_level;
}

double Skies::overcast_seen(const Vector3& direction_in_world) const {
  return overcast_at(std::max(kLowestSeenSine, sine_of_elevation(direction_in_world))) /
         overcast_level;
}

}  // namespace airtruth::insertion
