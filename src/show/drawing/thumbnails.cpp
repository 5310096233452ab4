// SPDX-License-Identifier: Apache-2.0
#include "show/drawing/thumbnails.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "aircraft/texture_file/picture.h"
#include "foundation/base/error.h"
#include "foundation/geometry/box.h"
#include "foundation/image/colour.h"
#include "picture/video/still.h"
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

// Without its JPEG.
Cutout place_of(const image::Picture& picture, const Box& box, const CutoutOptions& options) {
  Cutout cutout;
  const double largest = options.most_of_picture * std::max(picture.width, picture.height);
  cutout.px = std::clamp(std::round(options.surroundings * std::max(box.width, box.height)),
                         options.least_px,
                         std::max(options.least_px, largest));
  cutout.x = std::round(box.x + box.width / 2 - cutout.px / 2);
  cutout.y = std::round(box.y + box.height / 2 - cutout.px / 2);
  cutout.x = std::clamp(cutout.x, -cutout.px, static_cast<double>(picture.width));
  cutout.y = std::clamp(cutout.y, -cutout.px, static_cast<double>(picture.height));
  return cutout;
}

// The pixels of a cutout, scaled to `side` pixels. Those outside of the picture are black.
image::Rgb8 square(const image::Picture& picture, const Cutout& cutout, int side) {
  const int size = whole_pixels(cutout.px);
  const image::Rgb8 square = image::rgb8_from_picture(
      picture, {whole_pixels(cutout.x), whole_pixels(cutout.y), size, size});
  return resized(square, side, side, size > side ? cv::INTER_AREA : cv::INTER_CUBIC);
}

}  // namespace

image::Rgb8 strip(const std::vector<image::Rgb8>& pictures) {
  check(!pictures.empty(), "a strip has pictures");
  std::vector<cv::Mat> parts;
  for (const image::Rgb8& picture : pictures) parts.push_back(image::mat_of(picture));
  cv::Mat whole;
  cv::hconcat(parts, whole);
  return image::rgb8_of(whole);
}

image::Rgb8 enlarged(const image::Picture& picture, const Box& box, const CutoutOptions& options) {
  return square(picture, place_of(picture, box, options), options.side);
}

Cutout cutout_of(const image::Picture& picture, const Box& box, const CutoutOptions& options) {
  Cutout cutout = place_of(picture, box, options);
  cutout.jpeg = video::jpeg_of(square(picture, cutout, options.side), options.quality);
  return cutout;
}

Still still_of(const image::Picture& picture,
               std::size_t index,
               const std::optional<Box>& subject,
               const CutoutOptions& options) {
  Still still{.index = index, .width = picture.width};
  const double scale = std::min(1.0, static_cast<double>(options.whole_width) / picture.width);
  still.whole = video::jpeg_of(scaled(image::rgb8_from_picture(picture), scale, cv::INTER_AREA),
                               options.quality);
  if (subject) still.close = cutout_of(picture, *subject, options);
  return still;
}

void add_still(std::vector<html::PagePicture>& pictures,
               std::size_t sequence,
               std::size_t number,
               const Still& still) {
  pictures.push_back({fmt::format("whole-{}-{}", sequence, number), still.whole});
  pictures.push_back({fmt::format("close-{}-{}", sequence, number), still.close.jpeg});
}

std::set<std::size_t> spread_over(std::size_t frames, std::size_t count) {
  std::set<std::size_t> indices;
  const std::size_t most = std::min(frames, count);
  for (std::size_t n = 0; n < most; ++n)
    indices.insert(most > 1 ? n * (frames - 1) / (most - 1) : 0);
  return indices;
}

image::Rgb8 boxed(const std::string& jpeg, double scale, const std::vector<ColouredBox>& boxes) {
  cv::Mat picture = decoded(jpeg);
  if (!boxes.empty()) outline(picture, boxes[0].box, scale, kBlack, kRimmedPx + 2);
  for (std::size_t i = 0; i < boxes.size(); ++i)
    outline(picture,
            boxes[i].box,
            scale,
            cv::Scalar(boxes[i].rgb[0], boxes[i].rgb[1], boxes[i].rgb[2]),
            i == 0 ? kRimmedPx : 1);
  return image::rgb8_of(picture);
}

}  // namespace airtruth::drawing
