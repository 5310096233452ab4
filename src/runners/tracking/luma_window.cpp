// SPDX-License-Identifier: Apache-2.0
#include "runners/tracking/luma_window.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "foundation/base/error.h"
#include "foundation/image/mats.h"

namespace airtruth::tracking {
namespace {

// A part of a picture, reduced by whole blocks of pixels.
struct Reduced {
  cv::Mat source;
  // The place of its first pixel in the picture, and the size of one of its pixels there.
  double left = 0, top = 0;
  double across = 1, down = 1;
};

// The part of the picture that a window needs, with a margin, reduced by the largest power of two
// that keeps the window's pixels at least as large as the part's. A view of the picture if that
// power is 1.
Reduced reduced_part(
    const image::Plane& luma, double left, double top, double scale, int width, int height) {
  const int block = 1 << std::max(0, static_cast<int>(std::floor(std::log2(scale))));
  const auto whole_blocks = [&](double v) {
    return static_cast<int>(std::floor(v / block)) * block;
  };
  // What lies beyond the picture is its last row or column.
  const auto first = [&](double v, int size) {
    return std::clamp(whole_blocks(v) - 2 * block, 0, std::max(0, size - 4 * block));
  };
  const PixelBox part = {first(left, luma.width), first(top, luma.height), 0, 0};
  const auto extent = [&](double wanted, int from, int size) {
    return std::clamp(whole_blocks(wanted) + 6 * block, 1, size - from);
  };
  const int columns = extent(left + width * scale - part.x, part.x, luma.width);
  const int rows = extent(top + height * scale - part.y, part.y, luma.height);
  cv::Mat source = image::mat_of(luma)(cv::Rect(part.x, part.y, columns, rows));
  if (block > 1) {
    cv::Mat reduced;
    const cv::Size size(std::max(1, columns / block), std::max(1, rows / block));
    cv::resize(source, reduced, size, 0, 0, cv::INTER_AREA);
    source = reduced;
  }
  return {source,
          double(part.x),
          double(part.y),
          static_cast<double>(columns) / source.cols,
          static_cast<double>(rows) / source.rows};
}

}  // namespace

Pyramid::Pyramid(const image::Plane& luma, const PixelBox& part) {
  const auto inside = intersection(part, {0, 0, luma.width, luma.height});
  check(inside.has_value(), "a pyramid's part lies in the picture");
  width_ = inside->width;
  height_ = inside->height;
  stride_ = width_ + 1;
  sums_.resize(pixels_in(width_ + 1, height_ + 1), 0);
  for (int y = 0; y < height_; ++y) {
    const std::uint8_t* samples = luma.row(inside->y + y) + inside->x;
    const std::uint32_t* above = sums_.data() + offset(0, 1, y);
    std::uint32_t* here = sums_.data() + offset(0, 1, y + 1);
    std::uint32_t row = 0;
    for (int x = 0; x < width_; ++x) here[x] = above[x] + (row += samples[x]);
  }
}

image::Plane resampled(
    const image::Plane& luma, double left, double top, double scale, int width, int height) {
  const Reduced part = reduced_part(luma, left, top, scale, width, height);
  image::Plane plane;
  plane.width = width;
  plane.height = height;
  plane.stride = width;
  plane.samples = image::take_samples(pixels_in(width, height));
  cv::Mat target(height, width, CV_8UC1, plane.samples.get());
  // Between centres of pixels.
  const cv::Matx23d source_from_target(scale / part.across,
                                       0,
                                       (left + scale / 2 - part.left) / part.across - 0.5,
                                       0,
                                       scale / part.down,
                                       (top + scale / 2 - part.top) / part.down - 0.5);
  cv::warpAffine(part.source,
                 target,
                 source_from_target,
                 target.size(),
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REPLICATE);
  return plane;
}

}  // namespace airtruth::tracking
