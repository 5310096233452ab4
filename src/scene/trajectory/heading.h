// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "foundation/geometry/transform.h"

namespace airtruth::trajectory {

// Below this speed over the ground the direction of the velocity says little: a choice.
constexpr double kCourseMps = 0.1;
// The same where positions are measured: those of 0.1 m that a hover repeats, in means of half
// seconds, move by up to 0.4 m/s.
constexpr double kMeasuredCourseMps = 1;

// The heading of what is slower over the ground than `least_mps`: that of the last moment before
// which was not, held, then turned to that of the first moment after; where only one of the two
// exists, that one.
class Heading {
 public:
  // `velocity` is asked at times from the first to the last of `times_s`, which increase, and is
  // smooth between neighbouring ones.
  Heading(std::function<Vector3(double time_s)> velocity,
          std::vector<double> times_s,
          double least_mps)
      : velocity_(std::move(velocity)), times_s_(std::move(times_s)), least_mps_(least_mps) {}

  bool is_slow(const Vector3& velocity_mps) const;
  // The yaw at a time at which it is slow; empty where it is slow at all times. By several threads
  // at once.
  std::optional<double> held_deg_at(double time_s) const;

 private:
  struct Slow {
    double begin_s = 0;
    double end_s = 0;
    // At the two times, where it is not slow.
    std::optional<double> before_deg;
    std::optional<double> after_deg;
  };
  void look() const;
  double direction_deg(double time_s) const;
  double edge_s(double fast_s, double slow_s) const;
  double slowest_s(double begin_s, double end_s) const;

  std::function<Vector3(double time_s)> velocity_;
  std::vector<double> times_s_;
  double least_mps_;
  // Looked for once, when one is needed.
  mutable std::once_flag once_;
  mutable std::vector<Slow> slow_;
};

}  // namespace airtruth::trajectory
