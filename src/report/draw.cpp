// SPDX-License-Identifier: Apache-2.0
#include "report/draw.h"

#include <cmath>
#include <cstring>

#include <opencv2/imgproc.hpp>

namespace airtruth::report {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontHeightPx = 22.0;  // of a capital letter at scale 1

}  // namespace

cv::Mat view(image::Rgb8& picture) {
  return {picture.height, picture.width, CV_8UC3, picture.samples.get()};
}

image::Rgb8 from_mat(const cv::Mat& rgb) {
  image::Rgb8 picture = image::make_rgb8(rgb.cols, rgb.rows);
  for (int y = 0; y < rgb.rows; ++y)
    std::memcpy(picture.at(0, y), rgb.ptr(y), static_cast<std::size_t>(rgb.cols) * 3);
  return picture;
}

image::Rgb8 resized(const image::Rgb8& picture, int width, int height, int interpolation) {
  const cv::Mat source(picture.height, picture.width, CV_8UC3, picture.samples.get());
  cv::Mat target;
  cv::resize(source, target, cv::Size(width, height), 0, 0, interpolation);
  return from_mat(target);
}

void text(cv::Mat& canvas,
          const std::string& words,
          int x,
          int y,
          double size_px,
          const cv::Scalar& colour) {
  const double scale = size_px / kFontHeightPx;
  const int thickness = size_px > 20 ? 2 : 1;
  cv::putText(canvas, words, {x, y}, kFont, scale, cv::Scalar(0, 0, 0), thickness + 2, cv::LINE_AA);
  cv::putText(canvas, words, {x, y}, kFont, scale, colour, thickness, cv::LINE_AA);
}

int text_width(const std::string& words, double size_px) {
  int baseline = 0;
  return cv::getTextSize(words, kFont, size_px / kFontHeightPx, size_px > 20 ? 2 : 1, &baseline)
      .width;
}

void outline(
    cv::Mat& canvas, const Box& box, double scale, const cv::Scalar& colour, int thickness) {
  const int x0 = static_cast<int>(std::floor(box.x * scale)) - 1;
  const int y0 = static_cast<int>(std::floor(box.y * scale)) - 1;
  const int x1 = static_cast<int>(std::ceil(box.right() * scale));
  const int y1 = static_cast<int>(std::ceil(box.bottom() * scale));
  cv::rectangle(canvas, cv::Point(x0, y0), cv::Point(x1, y1), colour, thickness, cv::LINE_8);
}

}  // namespace airtruth::report
