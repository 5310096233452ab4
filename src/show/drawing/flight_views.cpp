// SPDX-License-Identifier: Apache-2.0
#include "show/drawing/flight_views.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "show/drawing/draw.h"

namespace airtruth::drawing {
namespace {

// The sizes of this file are display choices.

// Size of the text, and room for the numbers of an axis.
constexpr double kTextPx = 12;
constexpr int kMarginPx = 44;
constexpr int kShift = 4;  // cv::line takes sixteenths of a pixel

struct Range {
  double low = 0, high = 0;
  double span() const { return high - low; }
  double middle() const { return 0.5 * (low + high); }
};

// The range of a quantity over all points, at least `least` wide.
template <typename Value>
Range range_of(const std::vector<FlightLine>& lines, double least, const Value& value) {
  Range range{1e300, -1e300};
  for (const FlightLine& line : lines)
    for (std::size_t i = 0; i < line.times_s.size(); ++i) {
      const double x = value(line, i);
      range.low = std::min(range.low, x);
      range.high = std::max(range.high, x);
    }
  if (!(range.span() >= 0)) range = {0, 0};
  const double missing = std::max(0.0, least - range.span());
  return {range.low - 0.5 * missing, range.high + 0.5 * missing};
}

// 1, 2 or 5 times a power of ten, so that about five steps fill a span.
double tick_of(double span) {
  const double raw = span / 5;
  const double power = std::pow(10, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= raw) return factor * power;
  return 10 * power;
}

// From a plane's coordinates to pixels; y points up.
struct Axes {
  Range x, y;
  cv::Rect area;

  cv::Point2d at(double px, double py) const {
    return {area.x + (px - x.low) / x.span() * area.width,
            area.y + (y.high - py) / y.span() * area.height};
  }
};

void line(
    cv::Mat& canvas, cv::Point2d a, cv::Point2d b, const cv::Scalar& colour, int thickness = 1) {
  const auto fixed = [](cv::Point2d p) {
    return cv::Point(static_cast<int>(std::lround(p.x * (1 << kShift))),
                     static_cast<int>(std::lround(p.y * (1 << kShift))));
  };
  cv::line(canvas, fixed(a), fixed(b), colour, thickness, cv::LINE_AA, kShift);
}

void grid(cv::Mat& canvas, const Axes& axes, const std::string& x_name, const std::string& y_name) {
  const cv::Scalar faint(60, 60, 64);
  const auto ticks = [](const Range& range, const auto& draw) {
    const double tick = tick_of(range.span());
    for (double v = std::ceil(range.low / tick) * tick; v <= range.high + 1e-9 * tick; v += tick)
      draw(v);
  };
  const auto number = [](double v) { return fmt::format("{:g}", v == 0 ? 0.0 : v); };
  const auto write = [&](const std::string& words, int x, int y) {
    text(canvas, words, x, y, kTextPx, kGrey);
  };
  ticks(axes.x, [&](double v) {
    const cv::Point2d foot = axes.at(v, axes.y.low);
    line(canvas, foot, axes.at(v, axes.y.high), faint);
    write(number(v), int(foot.x) - text_width(number(v), kTextPx) / 2, int(foot.y) + 16);
  });
  ticks(axes.y, [&](double v) {
    const cv::Point2d foot = axes.at(axes.x.low, v);
    line(canvas, foot, axes.at(axes.x.high, v), faint);
    write(number(v), int(foot.x) - text_width(number(v), kTextPx) - 5, int(foot.y) + 4);
  });
  write(x_name, axes.area.br().x - text_width(x_name, kTextPx), canvas.rows - 6);
  write(y_name, 6, 16);
}

bool is_whole(double time_s) { return std::abs(time_s - std::round(time_s)) < 1e-6; }

template <typename Place>
void draw_line(cv::Mat& canvas, const FlightLine& flight, const Place& place) {
  for (std::size_t i = 1; i < flight.times_s.size(); ++i)
    line(canvas, place(flight, i - 1), place(flight, i), flight.colour, 2);
  for (std::size_t i = 0; i < flight.times_s.size(); ++i)
    if (is_whole(flight.times_s[i]))
      cv::circle(canvas, cv::Point(place(flight, i)), 3, flight.colour, cv::FILLED, cv::LINE_AA);
  if (!flight.times_s.empty()) {
    const cv::Point end(place(flight, flight.times_s.size() - 1));
    const int x = std::min(end.x + 7, canvas.cols - text_width(flight.name, kTextPx) - 4);
    text(canvas, flight.name, x, std::max(14, end.y - 6), kTextPx, flight.colour);
  }
}

// Thin lines between the own aircraft and the others at the same whole second.
template <typename Place>
void join_seconds(cv::Mat& canvas, const std::vector<FlightLine>& lines, const Place& place) {
  for (std::size_t n = 1; n < lines.size(); ++n)
    for (std::size_t i = 0; i < lines[n].times_s.size(); ++i) {
      if (!is_whole(lines[n].times_s[i])) continue;
      const auto& own = lines[0].times_s;
      const auto same = std::ranges::find_if(
          own, [&](double t) { return std::abs(t - lines[n].times_s[i]) < 1e-6; });
      if (same == own.end()) continue;
      const cv::Point2d from = place(lines[0], static_cast<std::size_t>(same - own.begin()));
      line(canvas, from, place(lines[n], i), lines[n].colour * 0.4);
    }
}

}  // namespace

image::Rgb8 plan_view(const std::vector<FlightLine>& lines,
                      double heading_deg,
                      double cone_deg,
                      int width,
                      int height) {
  cv::Mat canvas(height, width, CV_8UC3, kDarkPaper);
  const auto north = [](const FlightLine& l, std::size_t i) { return l.positions_ned_m[i].x(); };
  const auto east = [](const FlightLine& l, std::size_t i) { return l.positions_ned_m[i].y(); };
  // Least span of an axis, which gives a path that stands still a scale.
  constexpr double kLeastM = 20;
  Range x = range_of(lines, kLeastM, east), y = range_of(lines, kLeastM, north);
  const cv::Rect area(kMarginPx + 8, 24, width - kMarginPx - 24, height - 24 - kMarginPx);
  // One scale for both axes, and a twentieth of room around the paths.
  const double m_per_px = 1.1 * std::max(x.span() / area.width, y.span() / area.height);
  x = {x.middle() - 0.5 * m_per_px * area.width, x.middle() + 0.5 * m_per_px * area.width};
  y = {y.middle() - 0.5 * m_per_px * area.height, y.middle() + 0.5 * m_per_px * area.height};
  const Axes axes{x, y, area};
  grid(canvas, axes, "east, m", "north, m");
  const auto place = [&](const FlightLine& l, std::size_t i) {
    return axes.at(east(l, i), north(l, i));
  };
  if (!lines.empty() && !lines[0].times_s.empty()) {
    const double reach_m = 0.3 * std::min(x.span(), y.span());
    for (const double side : {-0.5, 0.5}) {
      const double a = radians(heading_deg + side * cone_deg);
      const cv::Point2d to = axes.at(east(lines[0], 0) + reach_m * std::sin(a),
                                     north(lines[0], 0) + reach_m * std::cos(a));
      line(canvas, place(lines[0], 0), to, kGrey);
    }
  }
  join_seconds(canvas, lines, place);
  for (const FlightLine& flight : lines) draw_line(canvas, flight, place);
  return image::rgb8_of(canvas);
}

image::Rgb8 height_view(const std::vector<FlightLine>& lines, int width, int height) {
  cv::Mat canvas(height, width, CV_8UC3, kDarkPaper);
  const auto time = [](const FlightLine& l, std::size_t i) { return l.times_s[i]; };
  const auto above = [](const FlightLine& l, std::size_t i) { return -l.positions_ned_m[i].z(); };
  // Least spans of the axes, which give a path that stands still a scale.
  constexpr double kLeastS = 1, kLeastM = 20;
  Range y = range_of(lines, kLeastM, above);
  y = {y.low - 0.08 * y.span(), y.high + 0.08 * y.span()};
  const Axes axes{range_of(lines, kLeastS, time),
                  y,
                  {kMarginPx + 8, 24, width - kMarginPx - 24, height - 24 - kMarginPx}};
  grid(canvas, axes, "time, s", "height, m");
  for (const FlightLine& flight : lines)
    draw_line(canvas, flight, [&](const FlightLine& l, std::size_t i) {
      return axes.at(time(l, i), above(l, i));
    });
  return image::rgb8_of(canvas);
}

image::Rgb8 table_picture(const std::vector<std::string>& heading,
                          const std::vector<TableRow>& rows,
                          int width) {
  // Height of a row, gap between columns, and room at the left.
  constexpr int kRowPx = 20, kGapPx = 26, kLeftPx = 12;
  std::vector<int> widths;
  for (std::size_t c = 0; c < heading.size(); ++c) {
    int widest = text_width(heading[c], kTextPx);
    for (const TableRow& row : rows) widest = std::max(widest, text_width(row.cells[c], kTextPx));
    widths.push_back(widest);
  }
  cv::Mat canvas(kRowPx * (static_cast<int>(rows.size()) + 1) + 14, width, CV_8UC3, kDarkPaper);
  const auto draw_row =
      [&](const std::vector<std::string>& cells, int y, const cv::Scalar& colour) {
        int x = kLeftPx;
        for (std::size_t c = 0; c < cells.size(); ++c) {
          // The first column is a name; numbers are set to the right.
          const int indent = c == 0 ? 0 : widths[c] - text_width(cells[c], kTextPx);
          text(canvas, cells[c], x + indent, y, kTextPx, colour);
          x += widths[c] + kGapPx;
        }
      };
  draw_row(heading, 18, kGrey);
  for (std::size_t r = 0; r < rows.size(); ++r)
    draw_row(rows[r].cells, 18 + kRowPx * (static_cast<int>(r) + 1), rows[r].colour);
  return image::rgb8_of(canvas);
}

}  // namespace airtruth::drawing
