// SPDX-License-Identifier: Apache-2.0
#include "evaluation/report/plots.h"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth::report {
namespace {

// Heights of figures, in units of which their width has 16: of one plot, of three below each other,
// and of a ranking.
constexpr double kPlotHeight = 9, kColumnHeight = 14;
constexpr double kRankingHeight = 2.5, kRankingHeightOfOne = 0.7;

plot::Format format_named(const std::string& name) {
  if (const auto known = enum_named<plot::Format>(name)) return *known;
  throw Error("--figures is '" + name + "'; expected png, pdf or svg");
}

}  // namespace

void keep(plot::Plot& plot, plot::Series series) {
  if (!series.x.empty()) plot.series.push_back(std::move(series));
}

std::vector<NamedPlot> with_data(std::vector<NamedPlot> plots) {
  std::erase_if(plots, [](const NamedPlot& one) { return one.plot.series.empty(); });
  return plots;
}

nlohmann::ordered_json json_of(const std::vector<NamedPlot>& plots) {
  auto json = nlohmann::ordered_json::object();
  for (const auto& [name, plot] : plots) json[name] = plot::json_of(plot);
  return json;
}

std::string counted_place(const std::string& name, double count) {
  return fmt::format("{} ({:.0f})", name, count);
}

plot::Plot ranking_plot(const std::string& measure, const std::vector<Ranked>& best_first) {
  plot::Plot plot{.x = {.label = measure + ", with 95 % interval over sequences", .min = 0}};
  plot::Series series{.mark = plot::Mark::kIntervals};
  for (auto row = best_first.rbegin(); row != best_first.rend(); ++row) {
    const auto interval = row->interval.value_or(evaluation::Interval{row->value, row->value});
    series.add(row->value, static_cast<double>(plot.y.names.size()), interval.low, interval.high);
    plot.y.names.push_back(row->name);
  }
  keep(plot, std::move(series));
  return plot;
}

Figures::Figures(const fs::path& out, const std::string& prefix, const std::string& format)
    : folder_(fs::absolute(out / "figures")), prefix_(prefix), format_(format_named(format)) {
  fs::create_directories(folder_);
}

void Figures::draw(const std::vector<NamedPlot>& plots) const {
  for (const auto& [name, plot] : plots)
    plot::draw({.plots = {plot}, .height = kPlotHeight}, folder_, prefix_ + name, format_);
}

void Figures::draw_ranking(const plot::Plot& ranking) const {
  if (ranking.series.empty()) return;
  const auto rows = static_cast<double>(ranking.y.names.size());
  plot::draw({.plots = {ranking},
              .height = kRankingHeight + kRankingHeightOfOne * rows,
              .legend = plot::Legend::kNone},
             folder_,
             prefix_ + "ranking",
             format_);
}

void Figures::draw_column(const std::vector<plot::Plot>& plots, const std::string& name) const {
  plot::draw({.plots = plots, .height = kColumnHeight}, folder_, prefix_ + name, format_);
}

void check_figures(const std::string& format) {
  format_named(format);
  plot::check_gnuplot("--figures");
}

}  // namespace airtruth::report
