// SPDX-License-Identifier: Apache-2.0
#include "evaluation/tracker_evaluation/plots.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <span>

#include "evaluation/matching/boxes.h"

namespace airtruth::tracker_evaluation {
namespace {

using plot::Plot;
using plot::Series;

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

// The centre of a box; a gap without one.
Pixel centre_or_gap(const std::optional<Box>& box) {
  return box ? matching::centre_of(*box) : Pixel(kGap, kGap);
}

Plot curve(const Assessment& assessment, const std::string& x, double step, const auto& of) {
  Plot plot{.x = {.label = x}, .y = {.label = "share of frames", .min = 0, .max = 1}};
  for (std::size_t k = 0; k < assessment.trackers.size(); ++k) {
    const ScoredTracker& tracker = assessment.trackers[k];
    if (!tracker.overall) continue;
    Series series{.name = tracker.name, .style = plot::style_of(k)};
    const std::span<const double> values = of(*tracker.overall);
    for (std::size_t j = 0; j < values.size(); ++j) {
      series.x.push_back(static_cast<double>(j) * step);
      series.y.push_back(values[j]);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

// Expected average overlap by length. The dash separates the two protocols here.
Plot eao_plot(const Assessment& assessment) {
  Plot plot{.x = {.label = "frames"},
            .y = {.label = "expected average overlap", .min = 0, .max = 1}};
  const auto add = [&](const std::vector<double>& values,
                       const std::string& name,
                       std::size_t tracker,
                       plot::Dash dash) {
    Series series{.name = name, .style = {plot::style_of(tracker).colour, dash}};
    for (std::size_t j = 1; j < values.size(); ++j) {
      series.x.push_back(static_cast<double>(j));
      series.y.push_back(values[j]);
    }
    report::keep(plot, std::move(series));
  };
  for (std::size_t k = 0; k < assessment.trackers.size(); ++k) {
    const ScoredTracker& tracker = assessment.trackers[k];
    if (tracker.restart)
      add(tracker.restart->eao_curve, tracker.name + ", restart", k, plot::Dash::kSolid);
    if (tracker.multistart)
      add(tracker.multistart->eao_curve, tracker.name + ", multi-start", k, plot::Dash::kLong);
  }
  return plot;
}

Plot bins_plot(const Assessment& assessment, const std::string& key, const std::string& x) {
  std::map<double, std::string> names;  // by the lower bound
  for (const ScoredTracker& tracker : assessment.trackers)
    if (const auto found = tracker.bins.find(key); found != tracker.bins.end())
      for (const measures::Bin& bin : found->second)
        names[bin.from] = report::name_of_bin(bin.from, bin.to);
  Plot plot{.x = {.label = x}, .y = {.label = "mean overlap", .min = 0}};
  for (const auto& [from, name] : names) plot.x.names.push_back(name);
  for (std::size_t k = 0; k < assessment.trackers.size(); ++k) {
    const auto found = assessment.trackers[k].bins.find(key);
    if (found == assessment.trackers[k].bins.end() || found->second.empty()) continue;
    Series series{.name = assessment.trackers[k].name,
                  .mark = plot::Mark::kLineAndPoints,
                  .style = plot::style_of(k)};
    for (const measures::Bin& bin : found->second) {
      series.x.push_back(static_cast<double>(std::distance(names.begin(), names.find(bin.from))));
      series.y.push_back(bin.overlap);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

Plot background_plot(const Assessment& assessment) {
  std::set<std::string> names;
  for (const ScoredTracker& tracker : assessment.trackers)
    for (const auto& [name, bin] : tracker.backgrounds) names.insert(name);
  Plot plot{.y = {.label = "mean overlap", .min = 0}};
  plot.x.names.assign(names.begin(), names.end());
  for (std::size_t k = 0; k < assessment.trackers.size(); ++k) {
    const auto& backgrounds = assessment.trackers[k].backgrounds;
    if (backgrounds.empty()) continue;
    Series series{
        .name = assessment.trackers[k].name, .mark = plot::Mark::kBars, .style = plot::style_of(k)};
    for (const auto& [name, bin] : backgrounds) {
      series.x.push_back(static_cast<double>(std::distance(names.begin(), names.find(name))));
      series.y.push_back(bin.overlap);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

}  // namespace

const ScoredSequence* scored_sequence(const Assessment& assessment,
                                      std::size_t tracker,
                                      std::size_t truth) {
  for (const ScoredSequence& sequence : assessment.trackers[tracker].sequences)
    if (sequence.truth == truth && sequence.score) return &sequence;
  return nullptr;
}

std::vector<report::NamedPlot> evaluation_plots(const Assessment& assessment) {
  using evaluation::Score;
  return report::with_data(
      {{"success",
        curve(assessment, "overlap", 0.05, [](const Score& s) { return std::span(s.success); })},
       {"precision",
        curve(assessment,
              "centre error, px",
              1,
              [](const Score& s) { return std::span(s.precision); })},
       {"normalised",
        curve(assessment,
              "centre error over size",
              0.01,
              [](const Score& s) { return std::span(s.normalised); })},
       {"eao", eao_plot(assessment)},
       {"range_m", bins_plot(assessment, "range_m", "range, m")},
       {"size_px", bins_plot(assessment, "size_px", "box size (longer side), px")},
       {"contrast", bins_plot(assessment, "contrast", "contrast, levels of 255")},
       {"background", background_plot(assessment)}});
}

Plot ranking_plot(const Assessment& assessment) {
  std::vector<report::Ranked> trackers;
  for (const ScoredTracker& tracker : assessment.trackers)
    if (tracker.overall)
      trackers.push_back({tracker.name, tracker.overall->auc, tracker.intervals.at("auc")});
  return report::ranking_plot("AUC", trackers);
}

std::vector<Plot> sequence_plots(const Assessment& assessment, std::size_t index) {
  const TruthClip& truth = assessment.truths[index];
  const auto& frames = truth.clip.frames;
  const auto first = static_cast<double>(frames.front().frame);
  const plot::Axis frame{.min = first,
                         .max = std::max(static_cast<double>(frames.back().frame), first + 1)};
  std::vector<Plot> plots = {{.x = frame, .y = {.label = "X, px"}},
                             {.x = frame, .y = {.label = "Y, px"}},
                             {.x = frame, .y = {.label = "error, px", .min = 0}}};
  plots[2].x.label = "frame";
  const auto add = [&](std::size_t panel, const Series& style, const auto& value) {
    Series series = style;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      series.x.push_back(static_cast<double>(frames[i].frame));
      series.y.push_back(value(i));
    }
    plots[panel].series.push_back(std::move(series));
  };
  for (const int side : {0, 1})
    add(static_cast<std::size_t>(side),
        {.name = "truth", .style = {plot::kInk, plot::Dash::kSolid, 3}},
        [&](std::size_t i) { return centre_or_gap(truth.box(i))[side]; });
  for (std::size_t k = 0; k < assessment.trackers.size(); ++k) {
    const ScoredSequence* sequence = scored_sequence(assessment, k, index);
    if (sequence == nullptr) continue;
    const Series style{.name = assessment.trackers[k].name, .style = plot::style_of(k)};
    for (const int side : {0, 1})
      add(static_cast<std::size_t>(side), style, [&](std::size_t i) {
        return centre_or_gap(sequence->answers[i])[side];
      });
    add(2, style, [&](std::size_t i) {
      return (centre_or_gap(truth.box(i)) - centre_or_gap(sequence->answers[i])).norm();
    });
  }
  return plots;
}

}  // namespace airtruth::tracker_evaluation
