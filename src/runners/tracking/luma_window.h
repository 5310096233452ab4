// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "foundation/image/picture.h"
#include "runners/tracking/pyramid.h"

namespace airtruth::tracking {

// Part of a picture's luma at several resolutions. Each of its pixels is `scale` pixels of the
// picture wide.
struct LumaWindow {
  Pyramid pyramid;
  double left = 0;  // position of the pyramid's corner in the picture, px
  double top = 0;
  double scale = 1;
};

// Resamples `width` x `height` pixels, beginning at (left, top). Beyond the picture, its border
// pixels are repeated. The result is made from means of whole blocks with linear interpolation
// between them.
image::Plane resampled(
    const image::Plane& luma, double left, double top, double scale, int width, int height);

}  // namespace airtruth::tracking
