// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/picture.h"

namespace airtruth::motion {

// The picture as the reference camera would have seen it: sample p of the result is sample H p of
// the picture, plane by plane. What the frame did not see is black.
image::Picture stabilised(const image::Picture& picture, const Homography& frame_from_reference);

// The same for a camera that turned: cam_from_reference, through its lens.
image::Picture stabilised(const image::Picture& picture,
                          const lens::Lens& lens,
                          const Quaternion& cam_from_reference);

}  // namespace airtruth::motion
