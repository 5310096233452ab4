// SPDX-License-Identifier: Apache-2.0
#include "show/drawing/boxed.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "foundation/base/error.h"
#include "show/drawing/draw.h"

namespace airtruth::drawing {
namespace {

// Thickness of the first box's line, in pixels.
constexpr int kRimmedPx = 2;

}  // namespace

image::Rgb8 boxed(const std::string& jpeg, double scale, const std::vector<ColouredBox>& boxes) {
  const std::vector<char> bytes(jpeg.begin(), jpeg.end());
  cv::Mat picture = cv::imdecode(bytes, cv::IMREAD_COLOR);
  if (picture.empty()) throw Error("a picture cannot be decoded");
  cv::cvtColor(picture, picture, cv::COLOR_BGR2RGB);
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
