// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "foundation/base/error.h"
#include "foundation/image/colour.h"
#include "show/drawing/draw.h"
#include "show/drawing/pictures.h"

namespace airtruth::drawing {
namespace {

image::Rgb8 alpha_picture(const image::Layer& layer, const PixelBox& area) {
  image::Rgb8 result = image::make_rgb8(area.width, area.height);
  const auto common = layer.empty() ? std::nullopt : intersection(layer.patch, area);
  if (!common) return result;
  for (int y = common->y; y < common->bottom(); ++y) {
    for (int x = common->x; x < common->right(); ++x) {
      const std::size_t i = layer.index(x, y);
      if (!layer.is_open(i)) continue;
      const float alpha = std::clamp(layer.pixels[i].alpha, 0.0f, 1.0f);
      std::fill_n(result.at(x - area.x, y - area.y),
                  3,
                  static_cast<std::uint8_t>(std::lround(alpha * 255)));
    }
  }
  return result;
}

// The change of each pixel, brightened fourfold.
image::Rgb8 difference_picture(const image::Rgb8& a, const image::Rgb8& b) {
  cv::Mat change;
  cv::absdiff(image::mat_of(a), image::mat_of(b), change);
  return image::rgb8_of(change * 4);
}

void paste(cv::Mat& canvas, const image::Rgb8& small, int zoom, int x, int y) {
  image::Rgb8 large = resized(small, small.width * zoom, small.height * zoom, cv::INTER_NEAREST);
  image::mat_of(large).copyTo(canvas(cv::Rect(x, y, large.width, large.height)));
}

void draw_boxes(cv::Mat& panel, const annotation::Frame& truth, const PixelBox& area, int zoom) {
  for (const annotation::Intruder& intruder : truth.intruders) {
    const auto draw = [&](const Box& box, const cv::Scalar& colour) {
      outline(panel, {box.x - area.x, box.y - area.y, box.width, box.height}, zoom, colour);
    };
    if (intruder.exact_box_px) draw(*intruder.exact_box_px, kAmber);
    if (intruder.visible_box_px) draw(as_box(*intruder.visible_box_px), kWhite);
    if (intruder.covered_box_px) draw(as_box(*intruder.covered_box_px), kGreen);
  }
}

// The sizes of this file are display choices.

// Gap between panels and around them.
constexpr int kPanelGapPx = 12;
// Height of two lines of text.
constexpr int kHeadingPx = 52;
// Width of the longest caption of a panel.
constexpr int kMinSlotPx = 110;
// Longest side of the picture, but for its margins.
constexpr int kMostPx = 4000;
// Size of the text.
constexpr double kCloseupTextPx = 12;

// The legend of the boxes' colours: each word has its colour. Words beyond the width are omitted.
void draw_heading(cv::Mat& canvas, std::int64_t frame, int zoom) {
  int x = kPanelGapPx;
  const auto add = [&](const std::string& words, const cv::Scalar& colour) {
    if (x + text_size(words, kCloseupTextPx).width > canvas.cols) return;
    text(canvas, words, x, 20, kCloseupTextPx, colour);
    x += text_width(words, kCloseupTextPx) + 2 * kPanelGapPx;
  };
  add(fmt::format("frame {}, {}x", frame, zoom), kWhite);
  add("covered box", kGreen);
  add("exact box", kAmber);
  add("visible box", kWhite);
}

}  // namespace

image::Rgb8 closeup(const Closeup& what,
                    const annotation::Frame& truth,
                    const PixelBox& area,
                    int largest_zoom) {
  const int zoom = std::clamp(
      std::min(kMostPx / (3 * area.width), kMostPx / area.height), 1, std::max(1, largest_zoom));
  check(what.background != nullptr && what.result != nullptr && largest_zoom > 0,
        "a closeup has its pictures");
  const image::Rgb8 before = image::rgb8_from_picture(*what.background, area);
  const image::Rgb8 after = image::rgb8_from_picture(*what.result, area);
  const image::Rgb8 middle =
      what.layer != nullptr ? alpha_picture(*what.layer, area) : difference_picture(before, after);
  const int panel = area.width * zoom;
  const int slot = std::max(panel, kMinSlotPx);
  cv::Mat canvas(kHeadingPx + area.height * zoom + kPanelGapPx,
                 4 * kPanelGapPx + 3 * slot,
                 CV_8UC3,
                 kDarkPaper);
  draw_heading(canvas, truth.frame, zoom);
  const std::array<std::string, 3> names = {
      "background", what.layer != nullptr ? "alpha" : "difference x4", "result"};
  const std::array<const image::Rgb8*, 3> pictures = {&before, &middle, &after};
  for (std::size_t i = 0; i < 3; ++i) {
    const int x = kPanelGapPx + static_cast<int>(i) * (slot + kPanelGapPx);
    text(
        canvas, fitted(names[i], kCloseupTextPx, slot), x, kHeadingPx - 10, kCloseupTextPx, kWhite);
    paste(canvas, *pictures[i], zoom, x, kHeadingPx);
    cv::Mat part = canvas(cv::Rect(x, kHeadingPx, panel, area.height * zoom));
    if (i == 2) draw_boxes(part, truth, area, zoom);
  }
  const double shrink = std::min(1.0, kMostPx / double(std::max(canvas.cols, canvas.rows)));
  if (shrink < 1) cv::resize(canvas, canvas, {}, shrink, shrink, cv::INTER_AREA);
  return image::rgb8_of(canvas);
}

}  // namespace airtruth::drawing
