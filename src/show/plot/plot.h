// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

// A plot described once: gnuplot draws it as a file (PNG, PDF, SVG), and a page draws it with
// Chart.js (drawPlot in show/html/assets/common.js).
//
// Example: a line from (0, 1) to (1, 0.5), its third point missing.
//
//   Plot plot{.title = "Success", .x = {"overlap"}, .y = {"share of frames", 0, 1}};
//   plot.series.push_back({.name = "am3", .x = {0, 1, 2}, .y = {1, 0.5, NAN}, .colour = 0});
//   draw({plot}, "figures", "success", "png", 9);  // figures/success.png, 1600 x 900 px
namespace airtruth::plot {

struct Axis {
  std::string label;  // with its unit
  std::optional<double> low = std::nullopt;
  std::optional<double> high = std::nullopt;
  // Names of the places 0, 1, ... of the axis; without names it is an axis of numbers.
  std::vector<std::string> names = {};
};

enum class Kind { kLine, kLineWithPoints, kPoints, kBars };

struct Series {
  std::string name;
  Kind kind = Kind::kLine;
  // As many values each; a NaN is a gap in the line. A series on an axis with names has a value for
  // every name.
  std::vector<double> x;
  std::vector<double> y;
  // Ends of a horizontal error bar around each point; empty, or as many values as points. Only
  // figures draw them.
  std::vector<double> x_low = {};
  std::vector<double> x_high = {};
  std::optional<std::size_t> colour = std::nullopt;  // see colour_of; the truth has no number
  std::size_t dash = 0;                              // index of kDashes
  double width = 1;                                  // of a usual line
};

struct Plot {
  std::string title =
      {};  // the caption on a page; figures have none, because a paper captions them
  Axis x = {};
  Axis y = {};
  std::vector<Series> series = {};
  bool legend = true;  // in figures; a page has one legend for all plots
};

// The plot as a page's script reads it; a NaN becomes null.
nlohmann::ordered_json to_json(const Plot& plot);

// Throws Error for a format other than "png", "pdf" and "svg", and where the program gnuplot is
// missing.
void check_gnuplot(const std::string& format);

// The script that draws the panels one below the other into NAME.FORMAT, with all data inside.
// `height` is for a width of 16: in hundreds of pixels for PNG (1600 px wide), in cm for PDF (16 cm
// wide) and in 50 px for SVG (800 px wide).
std::string gnuplot_script(const std::vector<Plot>& panels,
                           const std::string& name,
                           const std::string& format,
                           double height);

// Writes NAME.gnuplot into the folder and runs it, which writes NAME.FORMAT. Throws Error where
// gnuplot fails.
void draw(const std::vector<Plot>& panels,
          const std::filesystem::path& folder,
          const std::string& name,
          const std::string& format,
          double height);

}  // namespace airtruth::plot
