// SPDX-License-Identifier: Apache-2.0
#include "evaluation/detector_evaluation/plots.h"

#include <algorithm>
#include <map>
#include <set>

namespace airtruth::detector_evaluation {
namespace {

using plot::Plot;
using plot::Series;

Series series_of(const scores::Assessment& assessment, std::size_t k, plot::Mark mark) {
  return {.name = assessment.detectors[k].name, .mark = mark, .style = plot::style_of(k)};
}

// A value with its interval; nothing where there is none.
void add_point(Series& series, double x, const statistics::Proportion& share) {
  if (share.trials > 0) series.add(x, share.value, share.low, share.high);
}
void add_point(Series& series, double x, const std::optional<scores::WeightedMean>& mean) {
  if (!mean) return;
  const auto interval = mean->interval.value_or(evaluation::Interval{mean->mean, mean->mean});
  series.add(x, mean->mean, interval.low, interval.high);
}
void add_point(Series& series, double x, std::int64_t count) {
  series.add(x, static_cast<double>(count));
}

Plot precision_plot(const scores::Assessment& assessment,
                    std::optional<evaluation::PrecisionCurve> evaluation::AveragePrecision::*curve,
                    std::optional<evaluation::PrecisionBand> evaluation::AveragePrecision::*band) {
  Plot plot{.x = {.label = "recall", .min = 0, .max = 1},
            .y = {.label = "precision", .min = 0, .max = 1}};
  for (std::size_t k = 0; k < assessment.detectors.size(); ++k) {
    const evaluation::AveragePrecision& ap = assessment.detectors[k].average_precision;
    if (!(ap.*curve)) continue;
    Series series = series_of(assessment, k, plot::Mark::kLine);
    for (std::size_t i = 0; i < evaluation::kRecallSteps; ++i) {
      const double precision = (ap.*curve)->precision[i];
      series.add(static_cast<double>(i) / (evaluation::kRecallSteps - 1),
                 precision,
                 ap.*band ? (ap.*band)->low[i] : precision,
                 ap.*band ? (ap.*band)->high[i] : precision);
    }
    report::keep(plot, std::move(series));
  }
  return plot;
}

// The least positive value of an axis without zero: half of one event in all that was looked at.
double half_an_event(double looked_at) { return looked_at > 0 ? 0.5 / looked_at : 0; }

Plot froc_plot(const scores::Assessment& assessment,
               const std::string& label,
               double evaluation::FrocPoint::*rate,
               const auto& looked_at) {
  Plot plot{.x = {.label = label + " (none: at the left)", .is_logarithmic = true},
            .y = {.label = "probability of detection", .min = 0, .max = 1}};
  for (std::size_t k = 0; k < assessment.detectors.size(); ++k) {
    const evaluation::Froc& froc = assessment.detectors[k].froc;
    const double least = half_an_event(looked_at(froc));
    if (!(least > 0)) continue;
    Series series = series_of(assessment, k, plot::Mark::kLine);
    for (const evaluation::FrocPoint& point : froc.points)
      add_point(series, std::max(point.*rate, least), point.detection);
    report::keep(plot, std::move(series));
  }
  return plot;
}

template <typename Value>
Plot operating_plot(const scores::Assessment& assessment,
                    const std::string& label,
                    Value scores::OperatingPoint::*value,
                    std::optional<double> most = {}) {
  Plot plot{.x = {.label = "false tracks an hour (none: at the left)", .is_logarithmic = true},
            .y = {.label = label, .min = 0, .max = most}};
  for (std::size_t k = 0; k < assessment.detectors.size(); ++k) {
    const scores::DetectorScore& detector = assessment.detectors[k];
    const double least = half_an_event(detector.froc.hours);
    if (!detector.tracks || !(least > 0)) continue;
    Series series = series_of(assessment, k, plot::Mark::kLineAndPoints);
    for (const scores::OperatingPoint& point : detector.tracks->operating_curve)
      add_point(series, std::max(point.false_tracks_per_hour, least), point.*value);
    report::keep(plot, std::move(series));
  }
  return plot;
}

std::string name_of(const scores::Place& place) {
  return place.name.empty() ? plot::name_of_bin(place.from, place.to) : place.name;
}

// Every second place is shaded, so that the dots of one place are seen as a group.
void shade_places(Plot& plot) {
  constexpr plot::Colour kShade = {244, 246, 248};
  for (std::size_t place = 1; place < plot.x.names.size(); place += 2)
    plot.bands.push_back(
        {static_cast<double>(place) - 0.5, static_cast<double>(place) + 0.5, kShade});
}

Plot by_plot(const scores::Assessment& assessment, const scores::Quantity& quantity) {
  // The trials of the detector with the most, where they differ in what they saw.
  std::map<scores::Place, double> trials;
  const auto bins_of = [&](const scores::DetectorScore& detector) {
    const auto found = detector.by.find(quantity.key);
    return found == detector.by.end() ? std::vector<scores::DetectionBin>{} : found->second;
  };
  for (const scores::DetectorScore& detector : assessment.detectors)
    for (const scores::DetectionBin& bin : bins_of(detector))
      trials[bin.place] = std::max(trials[bin.place], bin.detection.trials);
  Plot plot{.x = {.label = quantity.title + " (aircraft)"},
            .y = {.label = "probability of detection", .min = 0, .max = 1}};
  for (const auto& [place, most] : trials)
    plot.x.names.push_back(report::counted_place(name_of(place), most));
  shade_places(plot);
  for (std::size_t k = 0; k < assessment.detectors.size(); ++k) {
    Series plain = series_of(assessment, k, plot::Mark::kDots);
    Series weighted = plain;
    weighted.name += ", weighted";
    weighted.is_hollow = true;
    for (const scores::DetectionBin& bin : bins_of(assessment.detectors[k])) {
      const auto place = static_cast<double>(std::distance(trials.begin(), trials.find(bin.place)));
      add_point(plain, place, bin.detection);
      if (bin.weighted) add_point(weighted, place, *bin.weighted);
    }
    report::keep(plot, std::move(plain));
    report::keep(plot, std::move(weighted));
  }
  return plot;
}

// Bars or dots over the keys of a map of each detector.
template <typename Value>
Plot named_plot(const scores::Assessment& assessment,
                const std::string& label,
                plot::Mark mark,
                std::map<std::string, Value> scores::DetectorScore::*values,
                std::optional<double> most = {}) {
  std::set<std::string> names;
  for (const scores::DetectorScore& detector : assessment.detectors)
    for (const auto& [name, value] : detector.*values) names.insert(name);
  Plot plot{.y = {.label = label, .min = 0, .max = most}};
  plot.x.names.assign(names.begin(), names.end());
  if (mark == plot::Mark::kDots) shade_places(plot);
  for (std::size_t k = 0; k < assessment.detectors.size(); ++k) {
    Series series = series_of(assessment, k, mark);
    for (const auto& [name, value] : assessment.detectors[k].*values)
      add_point(series, static_cast<double>(std::distance(names.begin(), names.find(name))), value);
    report::keep(plot, std::move(series));
  }
  return plot;
}

}  // namespace

std::vector<report::NamedPlot> detection_plots(const scores::Assessment& assessment) {
  std::vector<report::NamedPlot> plots = {
      {"precision",
       precision_plot(assessment,
                      &evaluation::AveragePrecision::curve_centre,
                      &evaluation::AveragePrecision::band_centre)},
      {"precision_50",
       precision_plot(assessment,
                      &evaluation::AveragePrecision::curve_50,
                      &evaluation::AveragePrecision::band_50)},
      {"froc",
       froc_plot(assessment,
                 "false alarms an image",
                 &evaluation::FrocPoint::false_alarms_per_image,
                 [](const evaluation::Froc& froc) { return static_cast<double>(froc.images); })},
      {"froc_hour",
       froc_plot(assessment,
                 "false alarms an hour",
                 &evaluation::FrocPoint::false_alarms_per_hour,
                 [](const evaluation::Froc& froc) { return froc.hours; })},
      {"operating",
       operating_plot(assessment, "mean declaration range, m", &scores::OperatingPoint::range_m)},
      {"declared",
       operating_plot(
           assessment, "share of encounters declared", &scores::OperatingPoint::declared, 1)}};
  for (const scores::Quantity& quantity : scores::quantities())
    plots.push_back({"by_" + quantity.key, by_plot(assessment, quantity)});
  plots.push_back({"false_alarms",
                   named_plot(assessment,
                              "false alarms",
                              plot::Mark::kBars,
                              &scores::DetectorScore::false_alarms_by)});
  plots.push_back({"mistaken",
                   named_plot(assessment,
                              "share of its frames taken for an aircraft",
                              plot::Mark::kDots,
                              &scores::DetectorScore::mistaken_by,
                              1)});
  return report::with_data(std::move(plots));
}

plot::Plot ranking_plot(const scores::Assessment& assessment) {
  std::vector<report::Ranked> detectors;
  for (const scores::DetectorScore& detector : assessment.detectors) {
    const evaluation::AveragePrecision& ap = detector.average_precision;
    if (ap.ap_centre) detectors.push_back({detector.name, *ap.ap_centre, ap.ap_centre_interval});
  }
  return report::ranking_plot("average precision", detectors);
}

}  // namespace airtruth::detector_evaluation
