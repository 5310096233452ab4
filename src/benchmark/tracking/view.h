// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "benchmark/tracking/pyramid.h"
#include "foundation/image/picture.h"

namespace airtruth::tracking {

// Part of a picture's luma, each of its pixels `scale` of the picture's wide, at several
// resolutions.
struct View {
  Pyramid pyramid;
  double left = 0;  // of the pyramid's corner, in the picture
  double top = 0;
  double scale = 1;
};

// `width` x `height` pixels from (left, top) on; the picture's border goes on beyond it. Made by
// means of whole blocks and, between them, linearly.
image::Plane resampled(
    const image::Plane& luma, double left, double top, double scale, int width, int height);

}  // namespace airtruth::tracking
