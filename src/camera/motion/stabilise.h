// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/picture.h"

namespace airtruth::motion {

// The picture as the reference camera would have seen it: pixel p of the result has the colour of
// pixel H p of the picture, bilinearly interpolated, plane by plane. Size and Colour are those of
// the picture. Pixels that the frame did not see are black.
//
// Example: where frame_from_reference is a translation by (3, 0), pixel (10.5, 20.5) of the result
// has the colour of pixel (13.5, 20.5) of the picture.
image::Picture stabilised(const image::Picture& picture, const Homography& frame_from_reference);

// The same for a rotation: cam_from_reference is the rotation of the frame's camera against the
// reference camera, and both have the same lens.
image::Picture stabilised(const image::Picture& picture,
                          const lens::Lens& lens,
                          const Quaternion& cam_from_reference);

}  // namespace airtruth::motion
