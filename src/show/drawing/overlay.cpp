// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "foundation/image/colour.h"
#include "show/drawing/draw.h"
#include "show/drawing/pictures.h"
#include "show/drawing/placing.h"

namespace airtruth::drawing {
namespace {

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
PixelBox outlined(const Box& box) { return wider(pixels_of(box), 2); }

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
  const auto covers = [&](const PixelBox& corner) {
    std::int64_t sum = 0;
    for (const PixelBox& box : placing.boxes) sum += common_px(corner, box);
    return sum;
  };
  return *std::ranges::min_element(
      corners, [&](const auto& a, const auto& b) { return covers(a) < covers(b); });
}

}  // namespace

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
    placing.boxes.push_back(outlined(one.box));
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
