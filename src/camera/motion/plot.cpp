// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/plot.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include <opencv2/imgproc.hpp>

namespace airtruth::motion {
namespace {

constexpr int kWidthPx = 1500;
constexpr int kPanelPx = 250;
constexpr int kLeftPx = 90;
constexpr int kRightPx = 30;
constexpr int kTopPx = 40;
const cv::Scalar kInk(40, 40, 45);
const cv::Scalar kFaint(225, 225, 228);
const cv::Scalar kBlue(31, 119, 180);
const cv::Scalar kOrange(230, 110, 20);

struct Series {
  std::string name;
  std::vector<double> values;
  cv::Scalar colour;
};

std::string label(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", std::abs(value) < 1e-12 ? 0.0 : value);
  return text;
}

void write(cv::Mat& canvas,
           const std::string& words,
           int x,
           int y,
           double scale,
           const cv::Scalar& colour) {
  cv::putText(canvas, words, {x, y}, cv::FONT_HERSHEY_SIMPLEX, scale, colour, 1, cv::LINE_AA);
}

double tidy_step(double range, int parts) {
  const double raw = std::max(range, 1e-9) / parts;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (double m : {1.0, 2.0, 5.0})
    if (m * power >= raw) return m * power;
  return 10 * power;
}

void shade_unmeasured(cv::Mat& canvas,
                      const std::vector<FrameMotion>& motion,
                      const cv::Rect& area) {
  const double per_frame =
      double(area.width) / static_cast<double>(std::max<std::size_t>(1, motion.size()));
  for (std::size_t i = 0; i < motion.size(); ++i) {
    if (is_known(motion[i].state)) continue;
    const int x0 = area.x + static_cast<int>(static_cast<double>(i) * per_frame);
    const int x1 =
        std::max(x0 + 1, area.x + static_cast<int>(static_cast<double>(i + 1) * per_frame));
    const cv::Scalar colour =
        motion[i].state == State::kCut ? cv::Scalar(250, 190, 190) : cv::Scalar(255, 228, 190);
    cv::rectangle(canvas, {x0, area.y}, {x1, area.y + area.height}, colour, cv::FILLED);
  }
}

struct Limits {
  double low = 0;
  double high = 1;
};

// The axis holds 0 and what the middle 98 % of the values span, widened by kBeyond of it on either
// side where values lie there: a single one far off does not press the others flat.
Limits limits_of(const std::vector<Series>& series) {
  constexpr double kTail = 0.01;
  constexpr double kBeyond = 1.0;
  std::vector<double> values;
  for (const Series& s : series)
    for (const double v : s.values)
      if (std::isfinite(v)) values.push_back(v);
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto tail = static_cast<std::size_t>(kTail * static_cast<double>(values.size()));
  const double low = std::min(0.0, values[tail]);
  const double high = std::max(0.0, values[values.size() - 1 - tail]);
  const double span = high - low;
  Limits limits{std::min(low, std::max(values.front(), low - kBeyond * span)),
                std::max(high, std::min(values.back(), high + kBeyond * span))};
  if (limits.high - limits.low < 1e-6) limits.high = limits.low + 1;
  const double margin = 0.06 * (limits.high - limits.low);
  if (limits.low < 0) limits.low -= margin;
  limits.high += margin;
  return limits;
}

// A line through the values; one beyond the axis is drawn at its end, under a small triangle.
// Returns how many are.
int draw_line(cv::Mat& canvas, const cv::Rect& area, const Limits& limits, const Series& s) {
  const auto count = static_cast<double>(std::max<std::size_t>(2, s.values.size()) - 1);
  int off_scale = 0;
  std::vector<cv::Point> line;
  for (std::size_t i = 0; i < s.values.size(); ++i) {
    const double v = s.values[i];
    const int x = area.x + static_cast<int>(static_cast<double>(i) / count * area.width);
    const double share = std::isfinite(v) ? (v - limits.low) / (limits.high - limits.low)
                         : v > 0          ? 2.0
                                          : -1.0;
    const int y = area.y + area.height -
                  static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * area.height));
    line.emplace_back(x, y);
    if (share >= 0 && share <= 1) continue;
    ++off_scale;
    const int inward = share > 1 ? 9 : -9;
    const std::vector<cv::Point> mark = {{x, y}, {x - 5, y + inward}, {x + 5, y + inward}};
    cv::fillConvexPoly(canvas, mark, s.colour, cv::LINE_AA);
  }
  if (line.size() > 1) cv::polylines(canvas, line, false, s.colour, 1, cv::LINE_AA);
  return off_scale;
}

void panel(cv::Mat& canvas,
           const std::vector<FrameMotion>& motion,
           int row,
           const std::string& unit,
           const std::vector<Series>& series) {
  const cv::Rect area(
      kLeftPx, kTopPx + row * (kPanelPx + kTopPx), kWidthPx - kLeftPx - kRightPx, kPanelPx);
  shade_unmeasured(canvas, motion, area);
  const Limits limits = limits_of(series);
  const double low = limits.low;
  const double high = limits.high;
  const auto y_of = [&](double v) {
    return area.y + area.height - (v - low) / (high - low) * area.height;
  };
  const double step = tidy_step(high - low, 5);
  for (double v = std::ceil(low / step) * step; v <= high; v += step) {
    const int y = static_cast<int>(y_of(v));
    cv::line(canvas, {area.x, y}, {area.x + area.width, y}, kFaint, 1);
    write(canvas, label(v), 12, y + 5, 0.45, kInk);
  }
  const auto count = static_cast<double>(std::max<std::size_t>(2, motion.size()) - 1);
  const double frames = tidy_step(count, 10);
  for (double f = 0; f <= count; f += frames)
    write(canvas,
          label(f),
          area.x + static_cast<int>(f / count * area.width) - 8,
          area.y + area.height + 18,
          0.42,
          kInk);
  cv::rectangle(canvas, area, kInk, 1);
  int off_scale = 0;
  int x = area.x + 6;
  write(canvas, unit, x, area.y - 10, 0.5, kInk);
  x += 40 + static_cast<int>(unit.size()) * 9;
  for (const Series& s : series) {
    cv::line(canvas, {x, area.y - 15}, {x + 26, area.y - 15}, s.colour, 2, cv::LINE_AA);
    write(canvas, s.name, x + 32, area.y - 10, 0.48, kInk);
    x += 60 + static_cast<int>(s.name.size()) * 9;
    off_scale += draw_line(canvas, area, limits, s);
  }
  if (off_scale > 0)
    write(canvas, std::to_string(off_scale) + " off the scale", x, area.y - 10, 0.48, kInk);
}

}  // namespace

image::Rgb8 plot(const std::vector<FrameMotion>& motion, int width, int height) {
  Series x{"centre, x", {}, kBlue}, y{"centre, y", {}, kOrange}, turn{"rotation", {}, kBlue},
      rms{"rms of the inliers", {}, kBlue}, inliers{"inliers", {}, kOrange};
  const Pixel centre(width / 2.0, height / 2.0);
  const bool rotations = !motion.empty() && motion.front().rotation;
  if (rotations) x.name = "yaw", y.name = "pitch", turn.name = "roll";
  for (const FrameMotion& m : motion) {
    rms.values.push_back(m.rms_px);
    inliers.values.push_back(m.inliers);
    if (rotations) {
      // Of the camera: right, up and clockwise.
      const Vector3 turned = vector_from_rotation(m.rotation->conjugate());
      x.values.push_back(degrees(turned.y()));
      y.values.push_back(degrees(turned.x()));
      turn.values.push_back(degrees(turned.z()));
      continue;
    }
    const Pixel moved = apply(m.frame_from_reference, centre);
    const Pixel right = apply(m.frame_from_reference, centre + Pixel(1, 0)) - moved;
    x.values.push_back(moved.x() - centre.x());
    y.values.push_back(moved.y() - centre.y());
    turn.values.push_back(degrees(std::atan2(right.y(), right.x())));
  }
  cv::Mat canvas(4 * (kPanelPx + kTopPx) + 56, kWidthPx, CV_8UC3, cv::Scalar(252, 252, 252));
  panel(canvas, motion, 0, rotations ? "degrees" : "px", {x, y});
  panel(canvas, motion, 1, "degrees", {turn});
  panel(canvas, motion, 2, "px", {rms});
  panel(canvas, motion, 3, "corners", {inliers});
  write(canvas,
        "frame (shaded: not measured; red: cut)",
        kLeftPx + 300,
        canvas.rows - 12,
        0.48,
        kInk);
  image::Rgb8 result = image::make_rgb8(canvas.cols, canvas.rows);
  for (int row = 0; row < canvas.rows; ++row)
    std::memcpy(result.at(0, row), canvas.ptr(row), static_cast<std::size_t>(canvas.cols) * 3);
  return result;
}

}  // namespace airtruth::motion
