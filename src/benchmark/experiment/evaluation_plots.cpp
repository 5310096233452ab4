// SPDX-License-Identifier: Apache-2.0
#include "benchmark/experiment/evaluation_plots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>

#include "show/plot/style.h"

namespace airtruth::experiment {
namespace {

using plot::Plot;
using plot::Series;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kTruthWidth = 3;

// Without values.
Series series_of(const Assessment& assessment, std::size_t tracker) {
  return {.name = assessment.trackers[tracker].name,
          .x = {},
          .y = {},
          .colour = tracker,
          .dash = plot::dash_of(tracker)};
}

Plot curve(const Assessment& assessment, Plot plot, double step, const auto& of) {
  plot.y = {.label = "share of frames", .low = 0, .high = 1};
  for (std::size_t k = 0; k < assessment.trackers.size(); ++k) {
    const ScoredTracker& tracker = assessment.trackers[k];
    if (!tracker.overall) continue;
    Series series = series_of(assessment, k);
    const auto& values = of(*tracker.overall);
    for (std::size_t j = 0; j < values.size(); ++j) {
      series.x.push_back(static_cast<double>(j) * step);
      series.y.push_back(values[j]);
    }
    plot.series.push_back(series);
  }
  return plot;
}

// Dashes distinguish the protocols.
Plot eao(const Assessment& assessment) {
  Plot plot{
      .title = fmt::format("Expected average overlap by length; the score is the mean over {} "
                           "to {} frames",
                           assessment.eao_range.first,
                           assessment.eao_range.second),
      .x = {.label = "frames"},
      .y = {.label = "expected average overlap", .low = 0, .high = 1}};
  const auto add =
      [&](std::size_t k, const char* protocol, std::size_t dash, const std::vector<double>& curve) {
        Series series = series_of(assessment, k);
        series.name += protocol;
        series.dash = dash;
        for (std::size_t j = 1; j < curve.size(); ++j) {
          series.x.push_back(static_cast<double>(j));
          series.y.push_back(curve[j]);
        }
        if (!series.x.empty()) plot.series.push_back(series);
      };
  for (std::size_t k = 0; k < assessment.trackers.size(); ++k) {
    const ScoredTracker& tracker = assessment.trackers[k];
    if (tracker.restart) add(k, ", restart", 0, tracker.restart->eao_curve);
    if (tracker.multistart) add(k, ", multi-start", 1, tracker.multistart->eao_curve);
  }
  return plot;
}

// The last bin has no end.
std::string name_of(const evaluation::Bin& bin) {
  return std::isfinite(bin.to) ? fmt::format("{:g}–{:g}", bin.from, bin.to)
                               : fmt::format("≥ {:g}", bin.from);
}

Plot by_bin(const Assessment& assessment, const std::string& key, const std::string& quantity) {
  Plot plot{.title = "Mean overlap by " + quantity,
            .x = {.label = quantity},
            .y = {.label = "mean overlap", .low = 0}};
  std::map<double, std::string> names;
  for (const ScoredTracker& tracker : assessment.trackers)
    if (const auto found = tracker.bins.find(key); tracker.overall && found != tracker.bins.end())
      for (const evaluation::Bin& bin : found->second) names.emplace(bin.from, name_of(bin));
  for (const auto& [from, name] : names) plot.x.names.push_back(name);
  for (std::size_t k = 0; k < assessment.trackers.size(); ++k) {
    const ScoredTracker& tracker = assessment.trackers[k];
    const auto found = tracker.bins.find(key);
    if (!tracker.overall || found == tracker.bins.end() || found->second.empty()) continue;
    Series series = series_of(assessment, k);
    series.kind = plot::Kind::kLineWithPoints;
    for (std::size_t i = 0; i < names.size(); ++i) series.x.push_back(static_cast<double>(i));
    series.y.assign(names.size(), kNone);
    for (const evaluation::Bin& bin : found->second) {
      const auto place = std::distance(names.begin(), names.find(bin.from));
      series.y[static_cast<std::size_t>(place)] = bin.overlap;
    }
    plot.series.push_back(series);
  }
  return plot;
}

Plot by_background(const Assessment& assessment) {
  Plot plot{.title = "Mean overlap by background",
            .x = {.label = "background"},
            .y = {.label = "mean overlap", .low = 0}};
  std::set<std::string> names;
  for (const ScoredTracker& tracker : assessment.trackers)
    if (tracker.overall)
      for (const auto& [name, bin] : tracker.backgrounds) names.insert(name);
  plot.x.names.assign(names.begin(), names.end());
  if (names.empty()) return plot;
  for (std::size_t k = 0; k < assessment.trackers.size(); ++k) {
    const ScoredTracker& tracker = assessment.trackers[k];
    if (!tracker.overall) continue;
    Series series = series_of(assessment, k);
    series.kind = plot::Kind::kBars;
    for (const std::string& name : names) {
      const auto found = tracker.backgrounds.find(name);
      series.x.push_back(static_cast<double>(series.x.size()));
      series.y.push_back(found == tracker.backgrounds.end() ? kNone : found->second.overlap);
    }
    plot.series.push_back(series);
  }
  return plot;
}

double centre(const std::optional<Box>& box, bool is_x) {
  if (!box) return kNone;
  return is_x ? evaluation::centre_of(*box).x() : evaluation::centre_of(*box).y();
}

double distance(const std::optional<Box>& a, const std::optional<Box>& b) {
  if (!a || !b) return kNone;
  return (evaluation::centre_of(*a) - evaluation::centre_of(*b)).norm();
}

}  // namespace

const ScoredSequence* scored(const Assessment& assessment, std::size_t tracker, std::size_t truth) {
  for (const ScoredSequence& sequence : assessment.trackers[tracker].sequences)
    if (sequence.truth == truth && sequence.score) return &sequence;
  return nullptr;
}

std::vector<std::pair<std::string, Plot>> evaluation_plots(const Assessment& assessment) {
  using evaluation::Score;
  std::vector<std::pair<std::string, Plot>> plots;
  const auto add = [&](const std::string& name, Plot plot) {
    if (!plot.series.empty()) plots.emplace_back(name, std::move(plot));
  };
  const auto add_curve = [&](const std::string& name,
                             const std::string& title,
                             const std::string& x,
                             double step,
                             const auto& of) {
    add(name, curve(assessment, {.title = title, .x = {.label = x}}, step, of));
  };
  add_curve(
      "success", "Success: share of frames with more overlap", "overlap", 0.05, [
      ](const Score& s) -> auto& { return s.success; });
  add_curve(
      "precision", "Precision: share of frames within a distance", "centre error, px", 1, [
      ](const Score& s) -> auto& { return s.precision; });
  add_curve(
      "normalised", "Normalised precision", "centre error over size", 0.01, [
      ](const Score& s) -> auto& { return s.normalised; });
  add("eao", eao(assessment));
  add("range_m", by_bin(assessment, "range_m", "range, m"));
  add("size_px", by_bin(assessment, "size_px", "box size (longer side), px"));
  add("contrast", by_bin(assessment, "contrast", "contrast, levels of 255"));
  add("background", by_background(assessment));
  return plots;
}

std::optional<Plot> ranking_plot(const Assessment& assessment) {
  Plot plot{.x = {.label = "AUC, with 95 % interval over sequences", .low = 0}, .legend = false};
  Series series{.kind = plot::Kind::kPoints, .x = {}, .y = {}, .colour = 0};
  for (auto tracker = assessment.trackers.rbegin(); tracker != assessment.trackers.rend();
       ++tracker) {
    if (!tracker->overall) continue;
    const double auc = tracker->overall->auc;
    const auto interval = tracker->intervals.at("auc").value_or(evaluation::Interval{auc, auc});
    series.x.push_back(auc);
    series.y.push_back(static_cast<double>(plot.y.names.size()));
    series.x_low.push_back(interval.low);
    series.x_high.push_back(interval.high);
    plot.y.names.push_back(tracker->name);
  }
  if (series.x.empty()) return std::nullopt;
  plot.series.push_back(series);
  return plot;
}

std::vector<Plot> sequence_plots(const Assessment& assessment, std::size_t index) {
  const TruthClip& truth = assessment.truths[index];
  const auto first = static_cast<double>(truth.clip.frames.front().frame);
  const double last = std::max(first + 1, static_cast<double>(truth.clip.frames.back().frame));
  std::vector<Plot> plots(3);
  for (Plot& plot : plots) plot = {.x = {.label = "", .low = first, .high = last}, .legend = false};
  plots[0].y.label = "X, px";
  plots[1].y.label = "Y, px";
  plots[2].y = {.label = "error, px", .low = 0};
  plots[2].x.label = "frame";
  plots[0].legend = true;
  const auto add = [&](std::size_t panel, Series series, const auto& value) {
    for (std::size_t i = 0; i < truth.clip.frames.size(); ++i) {
      series.x.push_back(static_cast<double>(truth.clip.frames[i].frame));
      series.y.push_back(value(i));
    }
    plots[panel].series.push_back(std::move(series));
  };
  for (const std::size_t panel : {0u, 1u})
    add(panel, {.name = "truth", .x = {}, .y = {}, .width = kTruthWidth}, [&](std::size_t i) {
      return centre(truth.box(i), panel == 0);
    });
  for (std::size_t k = 0; k < assessment.trackers.size(); ++k) {
    const ScoredSequence* sequence = scored(assessment, k, index);
    if (sequence == nullptr) continue;
    for (const std::size_t panel : {0u, 1u})
      add(panel, series_of(assessment, k), [&](std::size_t i) {
        return centre(sequence->answers[i], panel == 0);
      });
    add(2, series_of(assessment, k), [&](std::size_t i) {
      return distance(truth.box(i), sequence->answers[i]);
    });
  }
  if (plots[2].series.empty()) plots.pop_back();
  return plots;
}

}  // namespace airtruth::experiment
