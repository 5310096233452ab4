// SPDX-License-Identifier: Apache-2.0
#include "show/drawing/boxed.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "aircraft/texture_file/picture.h"
#include "show/drawing/draw.h"

namespace airtruth::drawing {
namespace {

// The sizes of this file are display choices.

// Thickness of the first box's line, in pixels.
constexpr int kRimmedPx = 2;

// The decoded pixels with the top row first. OpenCV's imgcodecs would decode them too, but loading
// that library takes 0.1 s at the start of every command (docs/optimisations.md).
cv::Mat decoded(const std::string& jpeg) {
  texture_file::Picture rows_from_below = texture_file::read_picture(jpeg);
  const cv::Mat rgba(
      rows_from_below.height, rows_from_below.width, CV_8UC4, rows_from_below.rgba.data());
  cv::Mat rgb;
  cv::cvtColor(rgba, rgb, cv::COLOR_RGBA2RGB);
  cv::flip(rgb, rgb, 0);
  return rgb;
}

}  // namespace

image::Rgb8 boxed(const std::string& jpeg, double scale, const std::vector<ColouredBox>& boxes) {
  cv::Mat picture = decoded(jpeg);
  if (!boxes.empty()) outline(picture, boxes[0].box, scale, kBlack, kRimmedPx + 2);
  for (std::size_t i = 0; i < boxes.size(); ++i)
    outline(picture,
            boxes[i].box,
            scale,
            cv::Scalar(boxes[i].rgb[0], boxes[i].rgb[1], boxes[i].rgb[2]),
            i == 0 ? kRimmedPx : 1);
  return from_mat(picture);
}

}  // namespace airtruth::drawing
