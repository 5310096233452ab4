// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/trajectory/path.h"

namespace airtruth::trajectory {

// The interface of every kind of path. Path calls at() only with times from start_s() to end_s().
struct Path::Impl {
  virtual ~Impl() = default;
  virtual double start_s() const = 0;
  virtual double end_s() const = 0;
  virtual State at(double time_s) const = 0;
};

// The spline through samples at strictly increasing times. Neighbouring samples may be equal: the
// object then stands still.
std::shared_ptr<const Path::Impl> path_through(std::vector<double> times_s,
                                               std::vector<Vector3> positions,
                                               const AttitudeOverride& attitude);

}  // namespace airtruth::trajectory
