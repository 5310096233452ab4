// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"

namespace airtruth::tracking {

// How much larger an object became from one frame to the next, from the flow of points within it
// (as median flow takes it: Kalal, Mikolajczyk and Matas 2010, "Forward-backward error: automatic
// detection of tracking failures", section 4). Points without texture are left out: they are the
// sky in the box's corners and stand still.
class ScaleFollower {
 public:
  // Keeps the object's picture.
  void keep(const image::Plane& luma, const Box& box);
  // The ratio since what was kept, within 0.9 to 1.1, `box` being where the object is now at its
  // old size. Empty where too few points can be followed.
  std::optional<double> ratio(const image::Plane& luma, const Box& box) const;

 private:
  image::Plane kept_;
};

}  // namespace airtruth::tracking
