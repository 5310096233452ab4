// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "foundation/base/error.h"
#include "foundation/image/colour.h"
#include "foundation/image/mats.h"
#include "show/drawing/draw.h"
#include "show/drawing/pictures.h"

namespace airtruth::drawing {
namespace {

// The sizes of this file are display choices.

// Width of a tile, and number of tiles side by side.
constexpr int kTileWidthPx = 640;
// Tallest picture of a tile: four times as high as wide.
constexpr int kMostTileHeightPx = 4 * kTileWidthPx;
// Smallest side of an inset in which an aircraft can be told: that of a box outline and two pixels.
constexpr int kLeastInsetPx = 8;
constexpr int kColumns = 3;
// Height of the line of text below a tile's picture.
constexpr int kCaptionPx = 22;
// Gap between insets, and size of their text.
constexpr int kInsetGapPx = 6;
constexpr double kTileTextPx = 12;
// Gap between tiles, and height of the title above them.
constexpr int kTileGapPx = 10;
constexpr int kSheetHeaderPx = 56;

// The square around an intruder that fills a close-up, in frame pixels.
PixelBox around(const PixelBox& box) {
  const int side = std::max({24, box.width * 3 / 2, box.height * 3 / 2});
  return {box.x + box.width / 2 - side / 2, box.y + box.height / 2 - side / 2, side, side};
}

PixelBox on_tile(const PixelBox& box, double scale) {
  return pixels_of({box.x * scale, box.y * scale, box.width * scale, box.height * scale});
}

// The square of `side` along the tile's upper or lower edge that overlaps no other inset and covers
// the least area of the boxes; among equal ones, the one farthest from `box`. nullopt where the
// insets leave no place.
std::optional<PixelBox> inset_place(const cv::Mat& tile,
                                    int side,
                                    const PixelBox& box,
                                    const std::vector<PixelBox>& boxes,
                                    const std::vector<PixelBox>& insets) {
  std::optional<PixelBox> best;
  std::pair<std::int64_t, double> least;
  const int step = side + kInsetGapPx;
  for (int column = 0; column * step + kInsetGapPx + side <= tile.cols; ++column) {
    for (const bool at_right : {false, true}) {
      for (const bool at_bottom : {false, true}) {
        const int x = kInsetGapPx + column * step;
        const PixelBox place{at_right ? tile.cols - x - side : x,
                             at_bottom ? tile.rows - side - kInsetGapPx : kInsetGapPx,
                             side,
                             side};
        const auto meets = [&](const PixelBox& other) {
          return intersection(place, other).has_value();
        };
        if (place.y < 0 || std::ranges::any_of(insets, meets)) continue;
        std::int64_t covered = 0;
        for (const PixelBox& one : boxes) covered += common_px(place, one);
        const double away = std::hypot(place.x + side / 2.0 - box.x - box.width / 2.0,
                                       place.y + side / 2.0 - box.y - box.height / 2.0);
        const std::pair<std::int64_t, double> cost{covered, -away};
        // An inset must not hide a box.
        if (boxes.size() > 2 && covered > 0) continue;
        if (best && !(cost < least)) continue;
        best = place;
        least = cost;
      }
    }
  }
  return best;
}

void draw_inset(cv::Mat& tile,
                const image::Picture& picture,
                const annotation::Intruder& intruder,
                const PixelBox& place,
                const cv::Scalar& colour) {
  const PixelBox area = around(*annotation::box_to_show(intruder));
  image::Rgb8 crop = image::rgb8_from_picture(picture, area);
  image::Rgb8 large = resized(
      crop, place.width, place.height, place.width > area.width ? cv::INTER_CUBIC : cv::INTER_AREA);
  image::mat_of(large).copyTo(tile(cv::Rect(place.x, place.y, place.width, place.height)));
  cv::rectangle(
      tile, cv::Rect(place.x - 1, place.y - 1, place.width + 2, place.height + 2), colour, 1);
  // Distance of the words from the inset's corner.
  constexpr int kInsetMarginPx = 4;
  const std::string range =
      intruder.range_m ? fmt::format(" {:.0f} m", *intruder.range_m) : std::string();
  const int room = place.width - 2 * kInsetMarginPx - text_width(range, kTileTextPx);
  const std::string shown = fitted(intruder.id, kTileTextPx, room) + range;
  const cv::Size size = text_size(shown, kTileTextPx);
  text_in(tile,
          shown,
          {place.x + kInsetMarginPx, place.y + kInsetMarginPx, size.width, size.height},
          kTileTextPx,
          colour);
}

// Outlines the visible intruders. Returns their outlines, in tile pixels.
std::vector<PixelBox> outline_intruders(cv::Mat& canvas,
                                        const annotation::Frame& truth,
                                        double scale) {
  std::vector<PixelBox> boxes;
  for (std::size_t i = 0; i < truth.intruders.size(); ++i) {
    if (!truth.intruders[i].visible_box_px) continue;
    const PixelBox around = wider(*annotation::box_to_show(truth.intruders[i]), 2);
    outline(canvas, as_box(around), scale, intruder_colour(i));
    boxes.push_back(on_tile(around, scale));
  }
  return boxes;
}

// Draws an enlarged inset of each visible intruder where it hides neither a box nor another inset.
void draw_insets(cv::Mat& canvas,
                 const image::Picture& picture,
                 const annotation::Frame& truth,
                 const std::vector<PixelBox>& boxes) {
  const int side = boxes.size() > 2 ? canvas.rows / 4 : canvas.rows * 2 / 5;
  if (side < kLeastInsetPx) return;
  std::vector<PixelBox> insets;
  std::size_t seen = 0;
  for (std::size_t i = 0; i < truth.intruders.size(); ++i) {
    if (!truth.intruders[i].visible_box_px) continue;
    const auto place = inset_place(canvas, side, boxes[seen++], boxes, insets);
    if (!place) continue;
    insets.push_back(*place);
    draw_inset(canvas, picture, truth.intruders[i], *place, intruder_colour(i));
  }
}

// A picture of another size in packed sRGB. To make a picture smaller its planes are reduced first,
// so that only the small picture is converted.
image::Rgb8 small_copy(const image::Picture& picture, int width, int height) {
  if (width >= picture.width)
    return resized(image::rgb8_from_picture(picture), width, height, cv::INTER_CUBIC);
  image::Picture small = image::make_picture(width, height, picture.colour);
  for (int p = 0; p < picture.plane_count; ++p) {
    cv::Mat target = image::mat_of(small.planes[static_cast<std::size_t>(p)]);
    cv::resize(image::mat_of(picture.planes[static_cast<std::size_t>(p)]),
               target,
               target.size(),
               0,
               0,
               cv::INTER_AREA);
  }
  return image::rgb8_from_picture(small);
}

// The picture with a line of text below it.
image::Rgb8 tile_of(const image::Picture& picture, const annotation::Frame& truth) {
  const double scale = std::min(static_cast<double>(kTileWidthPx) / picture.width,
                                static_cast<double>(kMostTileHeightPx) / picture.height);
  const int height = std::max(1, static_cast<int>(picture.height * scale));
  const int width =
      std::clamp(static_cast<int>(std::lround(picture.width * scale)), 1, kTileWidthPx);
  image::Rgb8 paper = dark_paper(kTileWidthPx, height + kCaptionPx);
  cv::Mat tile = image::mat_of(paper);
  image::Rgb8 small = small_copy(picture, width, height);
  cv::Mat canvas = tile(cv::Rect(0, 0, width, height));
  image::mat_of(small).copyTo(canvas);
  const std::vector<PixelBox> boxes = outline_intruders(canvas, truth, scale);
  draw_insets(canvas, picture, truth, boxes);
  text(tile,
       fmt::format("frame {}   {:.2f} s{}",
                   truth.frame,
                   truth.time_s,
                   boxes.empty() ? "   no intruder is seen" : ""),
       2,
       height + kCaptionPx - 7,
       kTileTextPx,
       boxes.empty() ? kGrey : kWhite);
  return paper;
}

// The arrangement of `count` tiles in a rectangle: at most kColumns side by side, and the largest
// number of tiles, up to `count`, that leaves no place empty.
struct Layout {
  int columns = 1;
  int tiles = 0;
};
Layout layout_of(int count) {
  if (count == 4) return {2, 4};
  if (count < kColumns) return {std::max(1, count), count};
  return {kColumns, count - count % kColumns};
}

// Places of `count` tiles of one size under a title, at least one row of them; draw(i, place) fills
// each.
template <typename Draw>
image::Rgb8 tiles_under(
    const std::string& title, cv::Size tile, int count, int columns, const Draw& draw) {
  const int rows = std::max(1, (count + columns - 1) / columns);
  image::Rgb8 paper = dark_paper(kTileGapPx + columns * (tile.width + kTileGapPx),
                                 kSheetHeaderPx + rows * (tile.height + kTileGapPx));
  cv::Mat canvas = image::mat_of(paper);
  text(canvas, fitted(title, 20, canvas.cols - 2 * kTileGapPx), kTileGapPx, 36, 20, kWhite);
  for (int i = 0; i < count; ++i) {
    const cv::Point corner(kTileGapPx + i % columns * (tile.width + kTileGapPx),
                           kSheetHeaderPx + i / columns * (tile.height + kTileGapPx));
    cv::Mat place = canvas(cv::Rect(corner, tile));
    draw(static_cast<std::size_t>(i), place);
    // A copy of another size leaves the sheet for memory of its own.
    check(place.size() == tile, "a tile is as large as its place");
  }
  return paper;
}

}  // namespace

image::Rgb8 tiled(const std::string& title,
                  const std::vector<NamedPicture>& pictures,
                  int columns) {
  check(!pictures.empty() && columns > 0, "there is something to tile");
  const cv::Size size(pictures[0].picture.width, pictures[0].picture.height);
  const auto count = static_cast<int>(pictures.size());
  return tiles_under(title, size, count, columns, [&](std::size_t i, cv::Mat& place) {
    image::mat_of(pictures[i].picture).copyTo(place);
    text(place, fitted(pictures[i].name, 12, size.width - 20), 10, size.height - 12, 12, kWhite);
  });
}

ContactSheet::ContactSheet(std::string title, std::int64_t frame_count_estimate, std::size_t tiles)
    : title_(std::move(title)), tiles_(tiles) {
  const auto wanted = static_cast<std::int64_t>(tiles);
  every_ = std::max<std::int64_t>(1, (frame_count_estimate + wanted - 1) / wanted);
}

void ContactSheet::add(const image::Picture& picture, const annotation::Frame& truth) {
  if (truth.frame % every_ != 0) return;
  // With more frames than expected, every other tile is dropped.
  if (chosen_.size() == tiles_) {
    every_ *= 2;
    std::erase_if(chosen_, [this](const Tile& tile) { return tile.frame % every_ != 0; });
    if (truth.frame % every_ != 0) return;
  }
  chosen_.push_back({truth.frame, tile_of(picture, truth)});
}

image::Rgb8 ContactSheet::sheet() const {
  const Layout layout = layout_of(static_cast<int>(chosen_.size()));
  const cv::Size tile(kTileWidthPx, chosen_.empty() ? 120 : chosen_[0].picture.height);
  const auto last = static_cast<std::size_t>(std::max(2, layout.tiles) - 1);
  image::Rgb8 paper =
      tiles_under(title_, tile, layout.tiles, layout.columns, [&](std::size_t i, cv::Mat& place) {
        // Spread evenly over all chosen frames, including the first and the last.
        image::mat_of(chosen_[i * (chosen_.size() - 1) / last].picture).copyTo(place);
      });
  cv::Mat canvas = image::mat_of(paper);
  if (chosen_.empty()) text(canvas, "no frames", kTileGapPx, kSheetHeaderPx + 40, 16, kGrey);
  return paper;
}

}  // namespace airtruth::drawing
