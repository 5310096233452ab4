// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "foundation/image/colour.h"
#include "show/drawing/draw.h"
#include "show/drawing/pictures.h"

namespace airtruth::drawing {
namespace {

// The sizes of this file are display choices.

// Distance between a box's outline and its label, in pixels.
constexpr int kGapPx = 3;
// Number of rings of candidate places; a label of 10 px reaches 2,000 px with them.
constexpr int kRings = 200;

bool is_allowed(const PixelBox& place, const Placing& placing) {
  const PixelBox& frame = placing.frame;
  if (place.x < frame.x || place.y < frame.y || place.right() > frame.right() ||
      place.bottom() > frame.bottom())
    return false;
  return std::ranges::none_of(
      placing.taken, [&](const PixelBox& other) { return intersection(place, other).has_value(); });
}

std::int64_t covered_px(const PixelBox& place, const std::vector<PixelBox>& boxes) {
  std::int64_t sum = 0;
  for (const PixelBox& box : boxes) sum += common_px(place, box);
  return sum;
}

// Places around `anchor` enlarged by `reach`. Above and below come first, since most aircraft are
// wider than tall.
std::array<PixelBox, 8> around(const PixelBox& anchor, int reach, int width, int height) {
  const int left = anchor.x - reach;
  const int right = anchor.right() + reach;
  const int above = anchor.y - reach - height;
  const int below = anchor.bottom() + reach;
  const int middle_y = anchor.y + (anchor.height - height) / 2;
  return {PixelBox{anchor.x, above, width, height},
          PixelBox{anchor.right() - width, above, width, height},
          PixelBox{anchor.x, below, width, height},
          PixelBox{anchor.right() - width, below, width, height},
          PixelBox{right, middle_y, width, height},
          PixelBox{left - width, middle_y, width, height},
          PixelBox{right, above, width, height},
          PixelBox{left - width, below, width, height}};
}

// The part of the anchor within the frame; its nearest pixel of the frame where there is none.
PixelBox inside(const PixelBox& anchor, const PixelBox& frame) {
  if (const auto common = intersection(anchor, frame)) return *common;
  return {std::clamp(anchor.x, frame.x, frame.right() - 1),
          std::clamp(anchor.y, frame.y, frame.bottom() - 1),
          1,
          1};
}

// The drawing data of one intruder.
struct Marked {
  std::string words;
  Box box;
  cv::Scalar colour;
  bool is_hidden = false;
};

std::vector<Marked> marked(const annotation::Frame& truth, const std::vector<std::string>& ids) {
  std::vector<Marked> result;
  for (std::size_t i = 0; i < truth.intruders.size(); ++i) {
    const annotation::Intruder& intruder = truth.intruders[i];
    const auto known = std::ranges::find(ids, intruder.id);
    const cv::Scalar colour =
        intruder_colour(known == ids.end() ? i : static_cast<std::size_t>(known - ids.begin()));
    const std::string words =
        intruder.range_m ? fmt::format("{} {:.0f} m", intruder.id, *intruder.range_m) : intruder.id;
    if (const auto shown = annotation::box_to_show(intruder))
      result.push_back({words, as_box(*shown), colour, false});
    else if (intruder.state == annotation::State::kHidden && intruder.exact_box_px)
      result.push_back({words + " (hidden)", *intruder.exact_box_px, colour, true});
  }
  return result;
}

// Draws the outline of a box with a dark rim, which is visible on a bright sky.
void draw_box(cv::Mat& canvas, const Marked& one) {
  outline(canvas, wider(one.box, 1), 1, kBlack);
  if (one.is_hidden)
    dashed_outline(canvas, one.box, 1, one.colour);
  else
    outline(canvas, one.box, 1, one.colour);
}

// Draws a line from a label to its box where the label is not next to it.
void draw_leader(cv::Mat& canvas, const PixelBox& label, const PixelBox& box, const Marked& one) {
  const cv::Point from(std::clamp(box.x + box.width / 2, label.x, label.right() - 1),
                       box.y < label.y ? label.y : label.bottom() - 1);
  const cv::Point to(std::clamp(from.x, box.x, box.right() - 1),
                     std::clamp(from.y, box.y, box.bottom() - 1));
  // A label that is this near to its box needs no line.
  constexpr double kNearPx = 6;
  if (cv::norm(from - to) > kNearPx) cv::line(canvas, from, to, one.colour, 1, cv::LINE_AA);
}

// Draws the frame's number in the corner where it covers the least area of the boxes.
PixelBox caption_place(const Placing& placing, int width, int height) {
  // Distance of the caption from the picture's border.
  constexpr int kMarginPx = 6;
  const int right = placing.frame.width - width - kMarginPx;
  const int bottom = placing.frame.height - height - kMarginPx;
  const std::array<PixelBox, 4> corners = {PixelBox{kMarginPx, bottom, width, height},
                                           PixelBox{right, bottom, width, height},
                                           PixelBox{kMarginPx, kMarginPx, width, height},
                                           PixelBox{right, kMarginPx, width, height}};
  return *std::ranges::min_element(
      corners, {}, [&](const PixelBox& corner) { return covered_px(corner, placing.boxes); });
}

}  // namespace

std::optional<PixelBox> place_label(const PixelBox& anchor,
                                    int width,
                                    int height,
                                    const Placing& placing) {
  const PixelBox& frame = placing.frame;
  if (width > frame.width || height > frame.height || width <= 0 || height <= 0)
    return std::nullopt;
  const PixelBox seen = inside(anchor, frame);
  std::optional<PixelBox> best;
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  for (int ring = 0; ring < kRings; ++ring) {
    const int reach = kGapPx + ring * height;
    if (reach > std::max(frame.width, frame.height)) break;
    for (PixelBox place : around(seen, reach, width, height)) {
      place.x = std::clamp(place.x, frame.x, frame.right() - width);
      if (!is_allowed(place, placing)) continue;
      const std::int64_t cost = covered_px(place, placing.boxes);
      if (cost == 0) return place;
      if (cost < least) {
        least = cost;
        best = place;
      }
    }
  }
  return best;
}

image::Rgb8 overlay(const image::Picture& picture,
                    const annotation::Frame& truth,
                    const std::vector<std::string>& ids) {
  image::Rgb8 result = image::rgb8_from_picture(picture);
  cv::Mat canvas = image::mat_of(result);
  const double size_px = std::clamp(picture.height / 55.0, 11.0, 30.0);
  const std::vector<Marked> all = marked(truth, ids);
  Placing placing{{0, 0, picture.width, picture.height}, {}, {}};
  for (const Marked& one : all) {
    draw_box(canvas, one);
    placing.boxes.push_back(wider(pixels_of(one.box), 2));
  }
  const std::string caption = fmt::format("frame {}  {:.2f} s", truth.frame, truth.time_s);
  const cv::Size caption_size = text_size(caption, size_px);
  const PixelBox at = caption_place(placing, caption_size.width, caption_size.height);
  placing.taken.push_back(at);
  text_in(canvas, caption, at, size_px, kWhite);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string words = fitted(all[i].words, size_px, picture.width);
    const cv::Size size = text_size(words, size_px);
    const auto place = place_label(placing.boxes[i], size.width, size.height, placing);
    // Labels already fill the picture.
    if (!place) continue;
    placing.taken.push_back(*place);
    draw_leader(canvas, *place, placing.boxes[i], all[i]);
    text_in(canvas, words, *place, size_px, all[i].colour);
  }
  return result;
}

}  // namespace airtruth::drawing
