// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/sky.h"

#include <algorithm>
#include <cmath>

namespace airtruth::synthetic {

Vector3 sun_in_world(double azimuth_deg, double elevation_deg) {
  const double azimuth = radians(azimuth_deg);
  const double elevation = radians(elevation_deg);
  return {std::cos(elevation) * std::cos(azimuth),
          std::cos(elevation) * std::sin(azimuth),
          -std::sin(elevation)};
}

Sky::Sky(const Vector3& sun_in_world) : sun_(sun_in_world) {
  // A low sun is redder and weaker.
  const float up = static_cast<float>(std::max(-sun_.z(), 0.02));
  const float air = 1 / (up + 0.05F);
  sunlight_ =
      1.12F * linear_rgb(std::exp(-0.03F * air), std::exp(-0.055F * air), std::exp(-0.11F * air));
}

LinearRgb Sky::at(const Vector3& direction) const {
  const float up = static_cast<float>(std::max(-direction.z(), 0.0));
  const float cosine = static_cast<float>(std::clamp(direction.dot(sun_), -1.0, 1.0));
  const LinearRgb zenith = linear_rgb(0.075F, 0.175F, 0.42F);
  const LinearRgb middle = linear_rgb(0.20F, 0.37F, 0.66F);
  const LinearRgb horizon = linear_rgb(0.60F, 0.70F, 0.80F);
  const float near_horizon = std::exp(-11 * up);
  const float low = std::exp(-2.6F * up);
  const float day = std::clamp(static_cast<float>(-sun_.z()) * 2.5F + 0.25F, 0.1F, 1.0F);
  LinearRgb sum = zenith + (middle - zenith) * low + (horizon - middle) * near_horizon;
  sum *= day * (0.86F + 0.22F * cosine * cosine);
  const float toward = std::max(cosine, 0.0F);
  const float glow = 0.10F * std::pow(toward, 6.0F) + 0.28F * std::pow(toward, 48.0F) +
                     1.1F * std::pow(toward, 700.0F) +
                     8.0F * smoothstep(0.99996F, 0.99999F, cosine);
  return sum + sunlight_ * glow;
}

LinearRgb Sky::haze(const Vector3& direction) const {
  Vector3 level(direction.x(), direction.y(), 0);
  level.normalize();
  return 0.97F * at(level);
}

}  // namespace airtruth::synthetic
