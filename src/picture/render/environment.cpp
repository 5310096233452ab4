// SPDX-License-Identifier: Apache-2.0
#include "picture/render/environment.h"

#include <algorithm>
#include <cmath>

namespace airtruth::render {
namespace {

// Bands of elevation, of equal solid angle. There are twice as many sectors of azimuth.
constexpr int kBands = 96;

// The real spherical harmonics up to order 2 (Ramamoorthi and Hanrahan 2001, eq. 3).
std::array<float, 9> harmonics(const Eigen::Vector3f& d) {
  const float x = d.x(), y = d.y(), z = d.z();
  return {0.282095f,
          0.488603f * y,
          0.488603f * z,
          0.488603f * x,
          1.092548f * x * y,
          1.092548f * y * z,
          0.315392f * (3 * z * z - 1),
          1.092548f * x * z,
          0.546274f * (x * x - y * y)};
}

constexpr std::array<std::size_t, 9> kOrder = {0, 1, 1, 1, 2, 2, 2, 2, 2};

}  // namespace

Environment Environment::of(const std::function<Rgb(const Vector3&)>& radiance) {
  constexpr int kAround = 2 * kBands;
  constexpr double kCellSr = 4 * kPi / (kBands * kAround);
  std::array<std::array<double, 3>, 9> sums{};
  for (int band = 0; band < kBands; ++band) {
    const double z = 1 - 2 * (band + 0.5) / kBands;
    const double r = std::sqrt(1 - z * z);
    for (int step = 0; step < kAround; ++step) {
      const double azimuth = 2 * kPi * (step + 0.5) / kAround;
      const Vector3 direction(r * std::cos(azimuth), r * std::sin(azimuth), z);
      const Rgb light = radiance(direction);
      const std::array<float, 9> y = harmonics(direction.cast<float>());
      for (std::size_t k = 0; k < 9; ++k)
        for (std::size_t c = 0; c < 3; ++c)
          sums[k][c] += kCellSr * static_cast<double>(y[k]) * static_cast<double>(light[c]);
    }
  }
  Environment result;
  for (std::size_t k = 0; k < 9; ++k)
    for (std::size_t c = 0; c < 3; ++c) result.coefficients_[k][c] = static_cast<float>(sums[k][c]);
  return result;
}

Environment& Environment::operator+=(const Environment& other) {
  for (std::size_t k = 0; k < 9; ++k)
    for (std::size_t c = 0; c < 3; ++c) coefficients_[k][c] += other.coefficients_[k][c];
  return *this;
}

Environment Environment::scaled(const Rgb& by) const {
  Environment result = *this;
  for (Rgb& coefficient : result.coefficients_)
    for (std::size_t c = 0; c < 3; ++c) coefficient[c] *= by[c];
  return result;
}

Rgb Environment::sum(const Eigen::Vector3f& direction, const std::array<float, 3>& by_order) const {
  const std::array<float, 9> y = harmonics(direction);
  Rgb result{};
  for (std::size_t k = 0; k < 9; ++k)
    for (std::size_t c = 0; c < 3; ++c)
      result[c] += by_order[kOrder[k]] * y[k] * coefficients_[k][c];
  for (float& channel : result) channel = std::max(0.0f, channel);
  return result;
}

// Multiplies by the coefficients of the cosine lobe over pi (Ramamoorthi and Hanrahan 2001, eq. 8).
Rgb Environment::irradiance_over_pi(const Eigen::Vector3f& normal_in_world) const {
  return sum(normal_in_world, {1, 2.0f / 3, 0.25f});
}

Rgb Environment::radiance(const Eigen::Vector3f& direction_in_world) const {
  return sum(direction_in_world, {1, 1, 1});
}

}  // namespace airtruth::render
