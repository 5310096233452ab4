// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "measure/calibration/calibration.h"
#include "show/drawing/draw.h"

namespace airtruth::calibration {
namespace {

constexpr int kWidth = 620;
constexpr int kHeight = 400;
constexpr int kLeft = 64;
constexpr int kTop = 44;
constexpr int kMargin = 40;
const cv::Scalar kInk(40, 40, 45);
const cv::Scalar kGrid(222, 222, 226);
const cv::Scalar kBlue(31, 119, 180);
const cv::Scalar kOrange(230, 110, 20);

struct Axes {
  cv::Rect area;
  double x0, x1, y0, y1;
  cv::Point at(double x, double y) const {
    return {area.x + static_cast<int>((x - x0) / (x1 - x0) * area.width),
            area.y + area.height - static_cast<int>((y - y0) / (y1 - y0) * area.height)};
  }
};

void words(cv::Mat& canvas, const std::string& text, int x, int y, double scale = 0.45) {
  cv::putText(canvas, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, scale, kInk, 1, cv::LINE_AA);
}

std::string number(double value) {
  return std::abs(value) >= 100 ? fmt::format("{:.0f}", value) : fmt::format("{:.3g}", value);
}

Axes axes(cv::Mat& canvas,
          int column,
          int row,
          const std::string& title,
          const std::string& across,
          std::array<double, 4> range) {
  const cv::Rect area(
      column * kWidth + kLeft, row * kHeight + kTop, kWidth - kLeft - 24, kHeight - kTop - kMargin);
  const Axes a{area, range[0], range[1], range[2], range[3]};
  for (int i = 0; i <= 5; ++i) {
    const double x = a.x0 + i * (a.x1 - a.x0) / 5;
    const double y = a.y0 + i * (a.y1 - a.y0) / 5;
    cv::line(canvas, a.at(a.x0, y), a.at(a.x1, y), kGrid, 1);
    words(canvas, number(x), a.at(x, 0).x - 12, area.y + area.height + 16, 0.38);
    words(canvas, number(y), area.x - 46, a.at(0, y).y + 4, 0.38);
  }
  cv::rectangle(canvas, area, kInk, 1);
  words(canvas, title, area.x, area.y - 12, 0.5);
  words(canvas,
        across,
        area.x + area.width - 9 * static_cast<int>(across.size()),
        area.y + area.height + 32,
        0.4);
  return a;
}

void nothing(cv::Mat& canvas, const Axes& a) {
  words(
      canvas, "not measured", a.area.x + a.area.width / 2 - 50, a.area.y + a.area.height / 2, 0.5);
}

}  // namespace

image::Rgb8 plot(const Calibration& c) {
  cv::Mat canvas(2 * kHeight, 2 * kWidth, CV_8UC3, cv::Scalar(252, 252, 252));
  double most = 1;
  for (const NoisePoint& p : c.noise) most = std::max(most, 1.2 * p.sigma_codes);
  const Axes noise = axes(canvas, 0, 0, "noise of luma, code values", "luma", {0, 1, 0, most});
  for (const NoisePoint& p : c.noise)
    cv::circle(canvas, noise.at(p.luma, p.sigma_codes), 4, kBlue, cv::FILLED, cv::LINE_AA);
  if (c.noise.empty()) nothing(canvas, noise);

  const Axes edge = axes(
      canvas,
      1,
      0,
      fmt::format(
          "step across {} sharp edges: {:.2f} px from 10 to 90 %", c.edge.edges, c.edge.spread_px),
      "px",
      {-6, 6, -0.3, 1.3});
  for (std::size_t i = 0; i < c.edge.place_px.size(); ++i) {
    cv::circle(canvas,
               edge.at(c.edge.place_px[i], std::clamp(c.edge.height[i], -0.3, 1.3)),
               3,
               kBlue,
               cv::FILLED,
               cv::LINE_AA);
    if (i > 0)
      cv::line(canvas,
               edge.at(c.edge.place_px[i - 1], c.edge.fitted[i - 1]),
               edge.at(c.edge.place_px[i], c.edge.fitted[i]),
               kOrange,
               2,
               cv::LINE_AA);
  }
  if (c.edge.edges == 0) nothing(canvas, edge);

  double low = -1, high = 1;
  for (const FrameHorizon& h : c.horizons) {
    low = std::min({low, h.pitch_deg, h.roll_deg});
    high = std::max({high, h.pitch_deg, h.roll_deg});
  }
  const Axes horizon = axes(canvas,
                            0,
                            1,
                            "horizon: pitch (blue), roll (orange), degrees",
                            "frame",
                            {0, std::max(1.0, double(c.frames)), low, high});
  for (const FrameHorizon& h : c.horizons) {
    cv::circle(canvas, horizon.at(double(h.frame), h.pitch_deg), 3, kBlue, cv::FILLED, cv::LINE_AA);
    cv::circle(
        canvas, horizon.at(double(h.frame), h.roll_deg), 3, kOrange, cv::FILLED, cv::LINE_AA);
  }
  if (c.horizons.empty()) nothing(canvas, horizon);

  words(canvas, "sky (tinted red)", kWidth + kLeft, kHeight + kTop - 12, 0.5);
  if (c.sky_picture) {
    const double scale = std::min(double(kWidth - kLeft - 24) / c.sky_picture->width,
                                  double(kHeight - kTop - 20) / c.sky_picture->height);
    image::Rgb8 small = drawing::resized(*c.sky_picture,
                                         static_cast<int>(c.sky_picture->width * scale),
                                         static_cast<int>(c.sky_picture->height * scale),
                                         cv::INTER_AREA);
    drawing::view(small).copyTo(
        canvas(cv::Rect(kWidth + kLeft, kHeight + kTop, small.width, small.height)));
  } else {
    words(canvas, "no horizon found", kWidth + kLeft + 180, kHeight + kTop + 160, 0.5);
  }
  return drawing::from_mat(canvas);
}

}  // namespace airtruth::calibration
