// SPDX-License-Identifier: Apache-2.0
#include "picture/shade/light.h"

#include <algorithm>
#include <cmath>

namespace airtruth::shade {
namespace {

// Number of bands of elevation, of equal solid angle. There are twice as many sectors of azimuth.
constexpr int kBands = 96;

// Factors of the harmonics of order 2 (Ramamoorthi and Hanrahan 2001, eq. 3).
constexpr float kProduct = 1.092548f;
constexpr float kZenith = 0.315392f;
constexpr float kDifference = 0.546274f;

// The real spherical harmonics up to order 2 (Ramamoorthi and Hanrahan 2001, eq. 3).
std::array<float, 9> harmonics(const Eigen::Vector3f& d) {
  const float x = d.x(), y = d.y(), z = d.z();
  return {0.282095f,
          0.488603f * y,
          0.488603f * z,
          0.488603f * x,
          kProduct * x * y,
          kProduct * y * z,
          kZenith * (3 * z * z - 1),
          kProduct * x * z,
          kDifference * (x * x - y * y)};
}

// Order of each of the nine harmonics.
constexpr std::array<std::size_t, 9> kOrder = {0, 1, 1, 1, 2, 2, 2, 2, 2};

}  // namespace

Environment Environment::of(const std::function<Rgb(const Vector3&)>& radiance) {
  // Number of sectors of azimuth, and the solid angle of a cell.
  constexpr int kAround = 2 * kBands;
  constexpr double kCellSr = 4 * kPi / (kBands * kAround);
  Eigen::Array<double, 4, 9> sums = Eigen::Array<double, 4, 9>::Zero();
  for (int band = 0; band < kBands; ++band) {
    const double z = 1 - 2 * (band + 0.5) / kBands;
    const double r = std::sqrt(1 - z * z);
    for (int step = 0; step < kAround; ++step) {
      const double azimuth = 2 * kPi * (step + 0.5) / kAround;
      const Vector3 direction(r * std::cos(azimuth), r * std::sin(azimuth), z);
      const Rgb light = radiance(direction);
      const std::array<float, 9> y = harmonics(direction.cast<float>());
      const Eigen::Array4d rgb(light[0], light[1], light[2], 0);
      for (std::size_t k = 0; k < 9; ++k)
        sums.col(static_cast<Eigen::Index>(k)) += kCellSr * static_cast<double>(y[k]) * rgb;
    }
  }
  Environment result;
  result.coefficients_ = sums.cast<float>();
  return result;
}

Environment& Environment::operator+=(const Environment& other) {
  coefficients_ += other.coefficients_;
  return *this;
}

Environment Environment::scaled(const Rgb& by) const {
  Environment result = *this;
  result.coefficients_.colwise() *= Eigen::Array4f(by[0], by[1], by[2], 0);
  return result;
}

// The harmonics of order 1 are a vector, and those of order 2 a symmetric matrix without a trace.
// Both turn as such.
Environment Environment::turned(const Eigen::Matrix3f& world_from_other) const {
  Environment result = *this;
  for (Eigen::Index c = 0; c < 3; ++c) {
    const auto of = [&](Eigen::Index k) { return coefficients_(c, k); };
    const Eigen::Vector3f v = world_from_other.transpose() * Eigen::Vector3f(of(3), of(1), of(2));
    Eigen::Matrix3f m;
    const float zz = 2 * kZenith * of(6);
    const float difference = kDifference * of(8);
    m << difference - zz / 2, kProduct * of(4) / 2, kProduct * of(7) / 2,  //
        kProduct * of(4) / 2, -difference - zz / 2, kProduct * of(5) / 2,  //
        kProduct * of(7) / 2, kProduct * of(5) / 2, zz;
    m = (world_from_other.transpose() * m * world_from_other).eval();
    result.coefficients_.row(c).tail<8>() << v.y(), v.z(), v.x(), 2 * m(0, 1) / kProduct,
        2 * m(1, 2) / kProduct, m(2, 2) / (2 * kZenith), 2 * m(0, 2) / kProduct,
        (m(0, 0) - m(1, 1)) / (2 * kDifference);
  }
  return result;
}

Rgb Environment::sum(const Eigen::Vector3f& direction, const std::array<float, 3>& by_order) const {
  const std::array<float, 9> y = harmonics(direction);
  Eigen::Array4f sum = Eigen::Array4f::Zero();
  for (std::size_t k = 0; k < 9; ++k)
    sum += by_order[kOrder[k]] * y[k] * coefficients_.col(static_cast<Eigen::Index>(k));
  return {std::max(0.0f, sum[0]), std::max(0.0f, sum[1]), std::max(0.0f, sum[2])};
}

// Multiplies by the coefficients of the cosine lobe over pi (Ramamoorthi and Hanrahan 2001, eq. 8).
Rgb Environment::irradiance_over_pi(const Eigen::Vector3f& normal_in_world) const {
  return sum(normal_in_world, {1, 2.0f / 3, 0.25f});
}

Rgb Environment::radiance(const Eigen::Vector3f& direction_in_world) const {
  return sum(direction_in_world, {1, 1, 1});
}

}  // namespace airtruth::shade
