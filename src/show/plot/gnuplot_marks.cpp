// SPDX-License-Identifier: Apache-2.0
#include "show/plot/gnuplot_marks.h"

#include <fmt/format.h>

namespace airtruth::plot {
namespace {

// Of dots and rings, in gnuplot's units.
constexpr double kDotSize = 1.2;

}  // namespace

std::string hex(const Colour& c) { return fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]); }

bool has_band(const Series& series) {
  return !series.low.empty() && (series.mark == Mark::kLine || series.mark == Mark::kLineAndPoints);
}

bool is_beside_others(const Series& series) {
  return series.mark == Mark::kBars || series.mark == Mark::kDots;
}

bool has_whiskers(const Series& series) { return !series.low.empty() && is_beside_others(series); }

std::string whiskers_of(const Series& series) {
  // gnuplot's yerrorbars have a white gap in the middle.
  return fmt::format(
      "using 1:3:(0):($4-$3) with vectors heads size graph 0.006,90 lw 1 lc rgb '{}'",
      series.mark == Mark::kDots ? hex(series.style.colour) : "#333333");
}

std::string drawn_as(const Series& series) {
  const std::string colour = fmt::format("lc rgb '{}'", hex(series.style.colour));
  const int dash = series.style.dash == Dash::kSolid ? 1 : series.style.dash == Dash::kLong ? 2 : 3;
  const std::string line = fmt::format("lw {} dt {} {}", series.style.width, dash, colour);
  switch (series.mark) {
    case Mark::kLine:
      return "using 1:2 with lines " + line;
    case Mark::kPoints:
      return "using 1:2 with points pt 7 ps 0.8 " + colour;
    case Mark::kLineAndPoints:
      return "using 1:2 with linespoints pt 7 ps 0.6 " + line;
    case Mark::kBars:
      return "using 1:2 with boxes " + colour;
    case Mark::kDots:
      return fmt::format(
          "using 1:2 with points pt {} ps {} {}", series.is_hollow ? 6 : 7, kDotSize, colour);
    case Mark::kIntervals:
      return "using 1:2:3:4 with xerrorbars pt 7 ps 1 " + colour;
    case Mark::kAbove:
      return "using 1:2 with points pt 9 ps 1 " + colour;
    case Mark::kBelow:
      return "using 1:2 with points pt 11 ps 1 " + colour;
  }
  return {};
}

std::string white_below_ring() {
  return fmt::format("using 1:2 with points pt 7 ps {} lc rgb '#ffffff'", kDotSize);
}

}  // namespace airtruth::plot
