// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "foundation/geometry/within_frame.h"
#include "labels/projection/exact_box.h"
#include "scene/trajectory/path.h"

namespace airtruth::sequence {

// Where a camera with the given shake stands, looks and moves at a time of its nominal path.
// `camera` is the path's state at that time. The lens must outlive the result.
projection::Sight sight_of(const lens::Lens& lens,
                           const Shutter& shutter,
                           const trajectory::Path& path,
                           const trajectory::State& camera,
                           double time_s,
                           const Shake& shake);

// The motion of an object on its path at that time; none if the shutter is instant.
Twist twist_of(const trajectory::Path& path,
               const trajectory::State& state,
               double time_s,
               const Shutter& shutter);

}  // namespace airtruth::sequence
