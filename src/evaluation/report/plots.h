// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <airtruth/statistics.h>
#include <nlohmann/json_fwd.hpp>

#include "show/plot/gnuplot.h"
#include "show/plot/plot.h"

// What the plots of trackers and of detectors have in common. A page and the figures for a paper
// draw the same ones.
namespace airtruth::report {

struct NamedPlot {
  std::string name;
  plot::Plot plot;
};

// Adds a series that has a point.
void keep(plot::Plot& plot, plot::Series series);
// Leaves out the plots without a series.
std::vector<NamedPlot> with_data(std::vector<NamedPlot> plots);
// The plots by name, as a page's script reads them.
nlohmann::ordered_json json_of(const std::vector<NamedPlot>& plots);

// The name of a place of an axis with the number of what is in it: "100–200 (40)".
std::string counted_place(const std::string& name, double count);

// The rows of a ranking, the best on top, with 95 % intervals of sequences; `measure` is the name
// beside the axis.
struct Ranked {
  std::string name;
  double value = 0;
  std::optional<evaluation::Interval> interval;
};
plot::Plot ranking_plot(const std::string& measure, const std::vector<Ranked>& best_first);

// Writes plots as files for a paper into out/figures, each with its gnuplot script and data beside
// it. `prefix` begins every name; the ranking is called "ranking". Throws Error where `format` is
// none of png, pdf and svg.
class Figures {
 public:
  Figures(const std::filesystem::path& out, const std::string& prefix, const std::string& format);
  void draw(const std::vector<NamedPlot>& plots) const;
  void draw_ranking(const plot::Plot& ranking) const;
  // Plots below each other in one file.
  void draw_column(const std::vector<plot::Plot>& plots, const std::string& name) const;
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
  std::string prefix_;
  plot::Format format_;
};

// Throws Error for a format that Figures refuses, and where the program gnuplot is missing, before
// any work begins.
void check_figures(const std::string& format);

}  // namespace airtruth::report
