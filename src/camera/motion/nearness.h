// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "foundation/base/median.h"
#include "foundation/geometry/transform.h"

// Near ground moves against what is far while the camera flies, and an intruder moves with what is
// far. Over level ground a point goes astray by up to (way flown / height) x sine of its depression
// under the horizon, since its range is height / sine. How much that is, the corners tell.
namespace airtruth::motion {

// Ground that lies by less under the horizon counts as far: its range is 14 heights or more. At
// 25 m/s and 50 m of height it moves by 0.05 mrad a frame of 1/30 s against the horizon.
constexpr double kFarDepressionDeg = 4;

struct Nearness {
  // Sine of the depression times the number of frames between two views. 0: above the horizon, or
  // nothing is known of where that is.
  double value = 0;
  bool is_far = true;  // above the horizon or less than kFarDepressionDeg under it
};

// in_any: the ray, and up, in one camera; up is a unit vector.
inline Nearness nearness_of(const Vector3& ray_in_any,
                            const Vector3& up_in_any,
                            std::int64_t frames) {
  const double sine = std::max(0.0, -up_in_any.dot(ray_in_any) / ray_in_any.norm());
  return {sine * static_cast<double>(frames), sine < std::sin(radians(kFarDepressionDeg))};
}

// The variance that parallax adds to a squared miss of two coordinates, per squared nearness: the
// median over the near points of what they miss by beyond noise. 0 where there are none.
class Parallax {
 public:
  explicit Parallax(double noise) : noise_(noise) {}
  void add(double squared_miss, const Nearness& near) {
    if (!near.is_far)
      ratios_.push_back(std::max(0.0, squared_miss - 2 * noise_ * noise_) /
                        (near.value * near.value));
  }
  double variance() {
    // Mean over median of chi squared with two degrees of freedom.
    constexpr double kMeanOverMedian = 2 / 1.386;
    return ratios_.empty() ? 0 : kMeanOverMedian * median(std::move(ratios_));
  }

 private:
  double noise_;
  std::vector<double> ratios_;
};

// How much a point counts: (noise / (noise + parallax))^2 in variances, the square since neighbours
// go astray alike and do not average out, times the weight of Geman and McClure (1987) against
// outliers. Ground that does not go astray counts in full: a camera high above it, or at rest,
// loses nothing.
inline double weight_of(
    double squared_miss, double noise, double scale, double limit, double of_parallax) {
  if (squared_miss > limit * limit + 4 * of_parallax) return 0;
  const double share = noise * noise / (noise * noise + of_parallax);
  const double e = squared_miss / (scale * scale + of_parallax);
  return share * share / ((1 + e) * (1 + e));
}

}  // namespace airtruth::motion
