// SPDX-License-Identifier: Apache-2.0
#include "comparison/comparison/figure.h"

#include <algorithm>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "foundation/geometry/box.h"
#include "foundation/image/colour.h"
#include "show/drawing/draw.h"

namespace airtruth::comparison {
namespace {

// The sizes of this file are display choices.

constexpr int kSmallPx = 44;    // of a crop at 1x, at most
constexpr int kMinCropPx = 24;  // beyond it stands the other one of a pair
constexpr int kLargePx = 352;   // of an enlarged crop
// Gaps between pictures, and heights of a heading and of its letters.
constexpr int kGapPx = 10;
constexpr int kHeadingPx = 34;
constexpr double kTextPx = 14;

Crop crop_of(const image::Picture& picture, const Box& box, int side) {
  const int x = whole_pixels(box.x + box.width / 2) - side / 2;
  const int y = whole_pixels(box.y + box.height / 2) - side / 2;
  return {image::rgb8_from_picture(picture, x, y, side, side),
          {box.x - x, box.y - y, box.width, box.height}};
}

image::Rgb8 tile_of(const image::Rgb8& crop, int side) {
  return drawing::resized(crop, side, side, crop.width > side ? cv::INTER_AREA : cv::INTER_NEAREST);
}

void paste(cv::Mat& canvas, image::Rgb8 picture, int x, int y) {
  drawing::view(picture).copyTo(canvas(cv::Rect(x, y, picture.width, picture.height)));
}

}  // namespace

FigureRow figure_row(const image::Picture& picture,
                     std::int64_t frame,
                     const Box& real,
                     const Box& made) {
  const double larger = std::max({real.width, real.height, made.width, made.height});
  const int side = std::clamp(whole_pixels(2 * larger), kMinCropPx, picture.width);
  return {frame, crop_of(picture, real, side), crop_of(picture, made, side)};
}

image::Rgb8 figure_of(const std::vector<FigureRow>& rows) {
  // Width of a pair of crops, each in two sizes.
  constexpr int kPairPx = 4 * kGapPx + 2 * (kSmallPx + kLargePx);
  const int columns = rows.size() > 1 ? 2 : 1;
  const int lines = (static_cast<int>(rows.size()) + columns - 1) / columns;
  cv::Mat canvas(kHeadingPx + lines * (kLargePx + kHeadingPx),
                 columns * (kPairPx + 2 * kGapPx),
                 CV_8UC3,
                 drawing::kDarkPaper);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    int x = kGapPx + static_cast<int>(i) % columns * (kPairPx + 2 * kGapPx);
    const int y = kHeadingPx + static_cast<int>(i) / columns * (kLargePx + kHeadingPx);
    for (const Crop* one : {&rows[i].real, &rows[i].made}) {
      const std::string name =
          one == &rows[i].real ? fmt::format("real, frame {}", rows[i].frame) : "inserted";
      drawing::text(canvas,
                    fmt::format("{}, {:.0f} x {:.0f} px", name, one->box.width, one->box.height),
                    x,
                    y - 8,
                    kTextPx,
                    drawing::kWhite);
      // At 1x as much as there is room for, from the middle.
      const int small = std::min(kSmallPx, one->picture.width);
      const int from = (one->picture.width - small) / 2;
      image::Rgb8 copy = tile_of(one->picture, one->picture.width);
      drawing::view(copy)(cv::Rect(from, from, small, small))
          .copyTo(canvas(cv::Rect(x, y, small, small)));
      x += kSmallPx + kGapPx;
      paste(canvas, tile_of(one->picture, kLargePx), x, y);
      cv::Mat large = canvas(cv::Rect(x, y, kLargePx, kLargePx));
      drawing::outline(large, one->box, double(kLargePx) / one->picture.width, drawing::kGreen);
      x += kLargePx + kGapPx;
    }
  }
  return drawing::from_mat(canvas);
}

image::Rgb8 patches_of(const FigureRow& row) {
  const int side = row.real.picture.width;
  cv::Mat canvas(side, 2 * side, CV_8UC3);
  paste(canvas, tile_of(row.real.picture, side), 0, 0);
  paste(canvas, tile_of(row.made.picture, side), side, 0);
  return drawing::from_mat(canvas);
}

}  // namespace airtruth::comparison
