// SPDX-License-Identifier: Apache-2.0
#include "show/drawing/draw.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include <opencv2/imgproc.hpp>

namespace airtruth::drawing {
namespace {

// The sizes of this file are display choices.

// OpenCV's sans-serif font.
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
// Height of a capital letter at scale 1, in pixels.
constexpr double kFontHeightPx = 22.0;
// Reach of the dark rim and its antialiasing beyond the letters, in pixels.
constexpr int kRimPx = 2;
// Length of a dash and of the gap after it.
constexpr int kDashPx = 6;

void dashed_line(cv::Mat& canvas, cv::Point from, cv::Point to, const cv::Scalar& colour) {
  const cv::Point step((to.x > from.x) - (to.x < from.x), (to.y > from.y) - (to.y < from.y));
  const int length = std::max(std::abs(to.x - from.x), std::abs(to.y - from.y));
  for (int at = 0; at <= length; at += 2 * kDashPx)
    cv::line(canvas, from + at * step, from + std::min(at + kDashPx, length) * step, colour, 1);
}

struct Corners {
  cv::Point low, high;
};
Corners corners_of(const Box& box, double scale) {
  const PixelBox pixels =
      pixels_of({box.x * scale, box.y * scale, box.width * scale, box.height * scale});
  return {{pixels.x - 1, pixels.y - 1}, {pixels.right(), pixels.bottom()}};
}

}  // namespace

image::Rgb8 dark_paper(int width, int height) {
  image::Rgb8 picture = image::make_rgb8(width, height);
  cv::Mat canvas = image::mat_of(picture);
  canvas.row(0) = kDarkPaper;  // OpenCV fills three channels pixel by pixel
  for (int y = 1; y < height; ++y)
    std::memcpy(picture.at(0, y), picture.at(0, 0), static_cast<std::size_t>(width) * 3);
  return picture;
}

image::Rgb8 resized(const image::Rgb8& picture, int width, int height, int interpolation) {
  cv::Mat target;
  cv::resize(image::mat_of(picture), target, cv::Size(width, height), 0, 0, interpolation);
  return image::rgb8_of(target);
}

image::Rgb8 scaled(const image::Rgb8& picture, double scale, int interpolation) {
  const auto side = [&](int px) { return std::max(1, static_cast<int>(std::lround(px * scale))); };
  return resized(picture, side(picture.width), side(picture.height), interpolation);
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

cv::Size text_size(const std::string& words, double size_px) {
  int baseline = 0;
  const int thickness = size_px > 20 ? 2 : 1;
  const cv::Size size =
      cv::getTextSize(words, kFont, size_px / kFontHeightPx, thickness + 2, &baseline);
  return {size.width + 2 * kRimPx, size.height + baseline + 2 * kRimPx};
}

void text_in(cv::Mat& canvas,
             const std::string& words,
             const PixelBox& place,
             double size_px,
             const cv::Scalar& colour) {
  int baseline = 0;
  const int thickness = size_px > 20 ? 2 : 1;
  const cv::Size size =
      cv::getTextSize(words, kFont, size_px / kFontHeightPx, thickness + 2, &baseline);
  text(canvas, words, place.x + kRimPx, place.y + kRimPx + size.height, size_px, colour);
}

std::string fitted(const std::string& words, double size_px, int width) {
  if (text_size(words, size_px).width <= width) return words;
  for (std::size_t keep = words.size(); keep > 0; --keep) {
    const std::string shorter = words.substr(0, keep - 1) + "...";
    if (text_size(shorter, size_px).width <= width) return shorter;
  }
  return "";
}

void outline(
    cv::Mat& canvas, const Box& box, double scale, const cv::Scalar& colour, int thickness) {
  const Corners corners = corners_of(box, scale);
  cv::rectangle(canvas, corners.low, corners.high, colour, thickness, cv::LINE_8);
}

void dashed_outline(cv::Mat& canvas, const Box& box, double scale, const cv::Scalar& colour) {
  const Corners corners = corners_of(box, scale);
  const cv::Point upper_right(corners.high.x, corners.low.y);
  const cv::Point lower_left(corners.low.x, corners.high.y);
  dashed_line(canvas, corners.low, upper_right, colour);
  dashed_line(canvas, upper_right, corners.high, colour);
  dashed_line(canvas, corners.high, lower_left, colour);
  dashed_line(canvas, lower_left, corners.low, colour);
}

cv::Scalar intruder_colour(std::size_t index) {
  static const std::array<cv::Scalar, 8> kColours = {cv::Scalar(0, 230, 160),
                                                     cv::Scalar(255, 165, 0),
                                                     cv::Scalar(90, 200, 255),
                                                     cv::Scalar(245, 130, 215),
                                                     cv::Scalar(245, 235, 70),
                                                     cv::Scalar(255, 90, 20),
                                                     cv::Scalar(70, 120, 255),
                                                     cv::Scalar(245, 245, 245)};
  return kColours[index % kColours.size()];
}

}  // namespace airtruth::drawing
