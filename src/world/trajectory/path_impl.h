// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "world/trajectory/path.h"

namespace airtruth::trajectory {

// What every kind of path knows; Path asks only for times between start_s() and end_s().
struct Path::Impl {
  virtual ~Impl() = default;
  virtual double start_s() const = 0;
  virtual double end_s() const = 0;
  virtual State at(double time_s) const = 0;
};

// The spline through samples, which may stand still (equal neighbours), at strictly increasing
// times.
std::shared_ptr<const Path::Impl> path_through(std::vector<double> times_s,
                                               std::vector<Vector3> positions,
                                               const AttitudeOverride& attitude);

}  // namespace airtruth::trajectory
