// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"

namespace airtruth::tracking {

// Measures the growth of an object from one frame to the next by the optical flow of points within
// it (the median flow of Kalal, Mikolajczyk and Matas 2010, "Forward-backward error: automatic
// detection of tracking failures", section 4). Points without texture are left out, because they
// belong to the sky in the box's corners and do not move.
class ScaleFollower {
 public:
  // Stores the object's picture.
  void keep(const image::Plane& luma, const Box& box);
  // Returns the ratio of sizes since keep(), between 0.9 and 1.1. `box` is the object's present
  // place at its old size. Returns empty where too few points can be followed.
  std::optional<double> ratio(const image::Plane& luma, const Box& box) const;

 private:
  image::Plane kept_;
};

}  // namespace airtruth::tracking
