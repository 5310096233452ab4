// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "image/colour.h"
#include "report/draw.h"
#include "report/pictures.h"

namespace airtruth::report {
namespace {

Box floating(const PixelBox& box) {
  return {double(box.x), double(box.y), double(box.width), double(box.height)};
}

void label(cv::Mat& canvas,
           const std::string& words,
           const Box& box,
           double size_px,
           const cv::Scalar& colour) {
  const int width = text_width(words, size_px);
  const int gap = static_cast<int>(size_px / 2) + 4;
  int x = static_cast<int>(box.x);
  int y = static_cast<int>(box.y) - gap;
  if (y < static_cast<int>(size_px) + 2) y = static_cast<int>(box.bottom() + size_px) + gap;
  x = std::clamp(x, 2, std::max(2, canvas.cols - width - 2));
  text(canvas, words, x, y, size_px, colour);
}

}  // namespace

image::Rgb8 overlay(const image::Picture& picture, const annotation::Frame& truth) {
  image::Rgb8 result = image::rgb8_from_picture(picture);
  cv::Mat canvas = view(result);
  const double size_px = std::clamp(picture.height / 60.0, 9.0, 30.0);
  for (const annotation::Intruder& intruder : truth.intruders) {
    const std::string words =
        intruder.range_m ? fmt::format("{} {:.0f} m", intruder.id, *intruder.range_m) : intruder.id;
    if (intruder.visible_box_px) {
      const Box box = floating(*intruder.visible_box_px);
      outline(canvas, box, 1, kGreen);
      label(canvas, words, box, size_px, kGreen);
    } else if (intruder.state == annotation::State::kHidden && intruder.exact_box_px) {
      outline(canvas, *intruder.exact_box_px, 1, kAmber);
      label(canvas, words + " (hidden)", *intruder.exact_box_px, size_px, kAmber);
    }
  }
  text(canvas,
       fmt::format("frame {}  {:.2f} s", truth.frame, truth.time_s),
       8,
       picture.height - 8,
       size_px,
       kWhite);
  return result;
}

}  // namespace airtruth::report
