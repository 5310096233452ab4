// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

namespace airtruth::motion {

struct HorizonEdge {
  Vector3 up_in_cam{0, -1, 0};
  // Share of the line, 0..1, across which luma steps by a code value more than the slope of the sky
  // above makes it step, the same way all along. A slope alone, however steep, is no edge.
  double sharpness = 0;
};

// The plane near a first guess of it along which luma steps most, less what the slope of the sky
// above makes it step: the picture is unrolled into elevation over azimuth about the guess, where
// planes near it are sines, and the step is summed along each, cut off at a few code values so that
// a weak step all along counts more than strong ones here and there. Coarse first, then about what
// was found.
HorizonEdge horizon_edge(const image::Picture& picture,
                         const lens::Lens& lens,
                         const image::Mask* own_aircraft,
                         const Vector3& guess_up_in_cam);
// The second step alone, for a guess that is good to a degree.
HorizonEdge horizon_edge_beside(const image::Picture& picture,
                                const lens::Lens& lens,
                                const image::Mask* own_aircraft,
                                const Vector3& guess_up_in_cam);

}  // namespace airtruth::motion
