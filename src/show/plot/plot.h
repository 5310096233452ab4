// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "foundation/image/picture.h"

// Plots as values: what a plot shows, apart from the library that draws it. A plot is described
// once. gnuplot draws it as a file (gnuplot.h), and Chart.js draws it on a page (drawPlot in
// show/html/assets/common.js).
//
// Example: the success curve of one tracker,
//
//   Plot plot;
//   plot.x = {.label = "overlap", .min = 0, .max = 1};
//   plot.y = {.label = "share of frames", .min = 0, .max = 1};
//   plot.series.push_back({.name = "am3", .style = style_of(0), .x = {0, 0.5, 1}, .y = {1, 0.8,
//   0}});
namespace airtruth::plot {

using Colour = std::array<std::uint8_t, 3>;  // red, green, blue of sRGB

// The colours of series, in order. The first six are distinguishable with every kind of colour
// vision (Okabe and Ito 2008, with a purple in place of their yellow).
inline constexpr std::array<Colour, 12> kColours = {{{0, 114, 178},
                                                     {230, 159, 0},
                                                     {213, 94, 0},
                                                     {86, 180, 233},
                                                     {170, 51, 119},
                                                     {0, 158, 115},
                                                     {93, 58, 155},
                                                     {140, 86, 75},
                                                     {127, 127, 127},
                                                     {184, 176, 0},
                                                     {244, 166, 200},
                                                     {46, 78, 142}}};
// The colour of truth, which no series has: black on paper, white on a dark page.
inline constexpr Colour kInk = {0, 0, 0};

// Lengths of dashes and gaps in units of a line's width; solid lines have none.
enum class Dash { kSolid, kLong, kShort };

struct Style {
  Colour colour = kColours[0];
  Dash dash = Dash::kSolid;
  // Relative to the width of a usual line.
  double width = 1;
};

// The style of the series with this index. The colours repeat from the 13th on. The dash changes
// with every six colours, so that series beyond the first six do not rely on their colour alone.
Style style_of(std::size_t index);

enum class Mark {
  kLine,
  kPoints,
  kLineAndPoints,
  kBars,       // upright, at whole x; several series stand side by side
  kDots,       // at whole x, side by side as bars are; for shares that have an interval
  kIntervals,  // points with a horizontal interval from `low` to `high`
  kAbove,      // triangles that point up: values above the axis
  kBelow,      // triangles that point down: values below the axis
};

struct Series {
  // The name in the legend; a series without a name is not in it.
  std::string name;
  Mark mark = Mark::kLine;
  Style style;
  // Equal in length. A y that is not finite is a gap in a line.
  std::vector<double> x, y;
  // Bounds, equal in length to x: of the horizontal interval of kIntervals, of the shaded band
  // about a line, or of the upright interval on a bar or a dot. Empty: none.
  std::vector<double> low = {}, high = {};
  // Of dots: they are rings.
  bool is_hollow = false;

  void add(double at, double value) {
    x.push_back(at);
    y.push_back(value);
  }
  void add(double at, double value, double from, double to) {
    add(at, value);
    low.push_back(from);
    high.push_back(to);
  }
};

struct Axis {
  std::string label;
  // Empty: the axis ends where the data end.
  std::optional<double> min = {}, max = {};
  // Names of the places 0, 1, 2, ...; empty for an axis of numbers.
  std::vector<std::string> names = {};
  // Of an axis of positive numbers; what is not positive is not drawn.
  bool is_logarithmic = false;
};

// A range of x that is shaded over the whole height.
struct Band {
  double from = 0, to = 0;
  Colour colour{};
};

struct Plot {
  // The text above the plot; it may be empty.
  std::string title;
  Axis x, y;
  std::vector<Series> series;
  std::vector<Band> bands = {};
  // A picture that is shown in place of axes and series; it must outlive the plot.
  const image::Rgb8* picture = nullptr;
};

// The name of a bin from one bound to another; an infinite one is open: "100–200", "< 50", "≥ 200",
// "-20 to -10".
std::string name_of_bin(double from, double to);

// A plot as a page's script reads it: title, x and y with label, min, max, names and logarithmic,
// and series with name, mark, style, x, y, low and high. Values that are not finite are null. Pages
// draw lines, points and bars with their bounds; horizontal intervals, triangles, bands of x and
// pictures are for files alone.
nlohmann::ordered_json json_of(const Plot& plot);

// A style as {"colour": "#0072b2", "dash": [7, 3], "width": 1}: dashes are in px for a line of
// usual width, and the colour of truth is "ink".
nlohmann::ordered_json json_of(const Style& style);

}  // namespace airtruth::plot
