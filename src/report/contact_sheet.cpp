// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "image/colour.h"
#include "report/draw.h"
#include "report/pictures.h"

namespace airtruth::report {
namespace {

constexpr int kTileWidthPx = 640;
constexpr int kColumns = 3;

// The square around an intruder that fills a close-up, in frame pixels.
PixelBox around(const PixelBox& box) {
  const int side = std::max({24, box.width * 3 / 2, box.height * 3 / 2});
  return {box.x + box.width / 2 - side / 2, box.y + box.height / 2 - side / 2, side, side};
}

void inset(cv::Mat& tile,
           const image::Picture& picture,
           const annotation::Intruder& intruder,
           double scale,
           int slot) {
  const PixelBox area = around(*intruder.visible_box_px);
  const int side = tile.rows * 2 / 5;
  image::Rgb8 crop = image::rgb8_from_picture(picture, area.x, area.y, area.width, area.height);
  image::Rgb8 large =
      resized(crop, side, side, side > area.width ? cv::INTER_CUBIC : cv::INTER_AREA);
  // The corner farthest from the intruder, further ones beside it.
  const PixelBox& box = *intruder.visible_box_px;
  const bool at_right = (box.x + box.width / 2.0) * scale < tile.cols / 2.0;
  const bool at_bottom = (box.y + box.height / 2.0) * scale < tile.rows / 2.0;
  const int step = slot * (side + 6);
  const int x = at_right ? tile.cols - side - 6 - step : 6 + step;
  const int y = at_bottom ? tile.rows - side - 6 : 6;
  if (x < 0 || x + side > tile.cols) return;
  view(large).copyTo(tile(cv::Rect(x, y, side, side)));
  cv::rectangle(tile, cv::Rect(x - 1, y - 1, side + 2, side + 2), kWhite, 1);
  text(tile,
       fmt::format("{} {:.0f} m", intruder.id, intruder.range_m.value_or(0)),
       x + 6,
       y + 20,
       12,
       kWhite);
}

image::Rgb8 tile_of(const image::Picture& picture, const annotation::Frame& truth) {
  const double scale = static_cast<double>(kTileWidthPx) / picture.width;
  const int height = std::max(1, static_cast<int>(picture.height * scale));
  image::Rgb8 tile = resized(image::rgb8_from_picture(picture),
                             kTileWidthPx,
                             height,
                             scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  cv::Mat canvas = view(tile);
  int slot = 0;
  for (const annotation::Intruder& intruder : truth.intruders) {
    if (!intruder.visible_box_px) continue;
    const PixelBox& v = *intruder.visible_box_px;
    outline(canvas, {v.x - 2.0, v.y - 2.0, v.width + 4.0, v.height + 4.0}, scale, kGreen);
    inset(canvas, picture, intruder, scale, slot++);
  }
  text(canvas,
       fmt::format("frame {}   {:.2f} s", truth.frame, truth.time_s),
       8,
       height - 10,
       12,
       kWhite);
  return tile;
}

}  // namespace

ContactSheet::ContactSheet(std::string title, std::int64_t frame_count_estimate, std::size_t tiles)
    : title_(std::move(title)), tiles_(tiles) {
  const auto wanted = static_cast<std::int64_t>(tiles);
  every_ = std::max<std::int64_t>(1, (frame_count_estimate + wanted - 1) / wanted);
}

void ContactSheet::add(const image::Picture& picture, const annotation::Frame& truth) {
  if (truth.frame % every_ != 0) return;
  if (chosen_.size() == tiles_) {  // more frames than were expected: keep every other one
    every_ *= 2;
    std::erase_if(chosen_, [this](const Tile& tile) { return tile.frame % every_ != 0; });
    if (truth.frame % every_ != 0) return;
  }
  chosen_.push_back({truth.frame, tile_of(picture, truth)});
}

image::Rgb8 ContactSheet::sheet() const {
  constexpr int kGapPx = 10;
  constexpr int kHeaderPx = 56;
  const int tile_height = chosen_.empty() ? 120 : chosen_[0].picture.height;
  const int rows = std::max<int>(1, (static_cast<int>(chosen_.size()) + kColumns - 1) / kColumns);
  cv::Mat canvas(kHeaderPx + rows * (tile_height + kGapPx),
                 kGapPx + kColumns * (kTileWidthPx + kGapPx),
                 CV_8UC3,
                 cv::Scalar(28, 28, 30));
  text(canvas, title_, kGapPx, 36, 20, kWhite);
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    const int column = static_cast<int>(i) % kColumns;
    const int row = static_cast<int>(i) / kColumns;
    const image::Rgb8& tile = chosen_[i].picture;
    const cv::Mat source(tile.height, tile.width, CV_8UC3, tile.samples.get());
    source.copyTo(canvas(cv::Rect(kGapPx + column * (kTileWidthPx + kGapPx),
                                  kHeaderPx + row * (tile_height + kGapPx),
                                  tile.width,
                                  tile.height)));
  }
  if (chosen_.empty()) text(canvas, "no frames", kGapPx, kHeaderPx + 40, 16, kGrey);
  return from_mat(canvas);
}

}  // namespace airtruth::report
