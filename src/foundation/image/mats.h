// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

namespace airtruth::image {

// Planes and masks as matrices of OpenCV, which share their samples. OpenCV has no matrix of
// constant samples: nothing may write to those of a constant plane or mask.
inline cv::Mat mat_of(const Plane& plane) {
  return {plane.height,
          plane.width,
          CV_8UC1,
          const_cast<std::uint8_t*>(plane.row(0)),
          static_cast<std::size_t>(plane.stride)};
}
inline cv::Mat mat_of(const Mask& mask) {
  return {mask.height, mask.width, CV_8UC1, const_cast<unsigned char*>(mask.free.data())};
}

}  // namespace airtruth::image
