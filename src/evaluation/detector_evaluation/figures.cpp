// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "evaluation/detector_evaluation/page.h"
#include "evaluation/detector_evaluation/plots.h"
#include "foundation/base/error.h"
#include "show/plot/gnuplot.h"

namespace airtruth::detector_evaluation {
namespace {

namespace fs = std::filesystem;

// Heights of figures for a width of 16.
constexpr double kPlotHeight = 9;
constexpr double kRankingHeight = 2.5, kRankingHeightOfOne = 0.7;

plot::Format format_named(const std::string& name) {
  if (name == "png") return plot::Format::kPng;
  if (name == "pdf") return plot::Format::kPdf;
  if (name == "svg") return plot::Format::kSvg;
  throw Error("--figures is '" + name + "'; expected png, pdf or svg");
}

// Average precision at the centre distance, the best at the top.
plot::Plot ranking_plot(const detector_scores::Assessment& assessment) {
  plot::Plot plot{.x = {.label = "average precision, with 95 % interval over sequences", .min = 0}};
  plot::Series series{.mark = plot::Mark::kIntervals};
  for (auto detector = assessment.detectors.rbegin(); detector != assessment.detectors.rend();
       ++detector) {
    const detection_measures::AveragePrecision& ap = detector->average_precision;
    if (!ap.ap_centre) continue;
    const auto interval =
        ap.ap_centre_interval.value_or(evaluation::Interval{*ap.ap_centre, *ap.ap_centre});
    series.x.push_back(*ap.ap_centre);
    series.y.push_back(static_cast<double>(plot.y.names.size()));
    series.low.push_back(interval.low);
    series.high.push_back(interval.high);
    plot.y.names.push_back(detector->name);
  }
  if (!series.x.empty()) plot.series.push_back(std::move(series));
  return plot;
}

}  // namespace

void write_figures(const detector_scores::Assessment& assessment,
                   const fs::path& out,
                   const std::string& format) {
  const plot::Format file = format_named(format);
  const fs::path folder = fs::absolute(out / "figures");
  fs::create_directories(folder);
  for (const auto& [name, plot] : detection_plots(assessment))
    plot::draw({.plots = {plot}, .height = kPlotHeight}, folder, "detection_" + name, file);
  const plot::Plot ranking = ranking_plot(assessment);
  if (ranking.series.empty()) return;
  plot::draw(
      {.plots = {ranking},
       .height = kRankingHeight + kRankingHeightOfOne * static_cast<double>(ranking.y.names.size()),
       .legend = plot::Legend::kNone},
      folder,
      "detection_ranking",
      file);
}

}  // namespace airtruth::detector_evaluation
