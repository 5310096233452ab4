// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "foundation/image/colour.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

namespace airtruth::image {

// Planes, masks and packed pictures as matrices of OpenCV, which share their samples. OpenCV has no
// matrix of constant samples: nothing may write to those of a constant plane, mask or picture.
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
inline cv::Mat mat_of(const Rgb8& rgb) {
  return {rgb.height, rgb.width, CV_8UC3, rgb.samples.get()};
}

// The luma of a part of a picture, inside it. It shares the picture's samples; of red, green and
// blue it is a matrix of its own.
inline cv::Mat luma_of(const Picture& picture, const PixelBox& part) {
  if (picture.colour.matrix != Matrix::kRgb)
    return mat_of(picture.luma())(cv::Rect(part.x, part.y, part.width, part.height));
  cv::Mat luma(part.height, part.width, CV_8UC1);
  for (int y = 0; y < part.height; ++y)
    copy_luma(picture, part.x, part.y + y, part.width, luma.ptr(y));
  return luma;
}
inline cv::Mat luma_of(const Picture& picture) {
  return luma_of(picture, {0, 0, picture.width, picture.height});
}

// Copies the samples.
inline Rgb8 rgb8_of(const cv::Mat& mat) {
  Rgb8 rgb = make_rgb8(mat.cols, mat.rows);
  mat.copyTo(mat_of(rgb));
  return rgb;
}

}  // namespace airtruth::image
