// SPDX-License-Identifier: Apache-2.0
#include "evaluation/tracker_evaluation/page.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <airtruth/version.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "evaluation/report/plots.h"
#include "evaluation/report/tables.h"
#include "evaluation/statistics/bins.h"
#include "evaluation/tracker_evaluation/tables.h"
#include "foundation/base/files.h"
#include "foundation/geometry/box.h"
#include "picture/video/still.h"
#include "show/drawing/pictures.h"
#include "show/html/page.h"
#include "show/plot/plot.h"

namespace airtruth::tracker_evaluation {
namespace {

using plot::Plot;
using plot::Series;

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

// The centre of a box; a gap without one.
Pixel centre_or_gap(const std::optional<Box>& box) {
  return box ? centre_of(*box) : Pixel(kGap, kGap);
}

// `values`: the curve's member of Score.
Plot curve(const Assessment& assessment, const std::string& x, double step, auto values) {
  Plot plot{.x = {.label = x}, .y = {.label = "share of frames", .min = 0, .max = 1}};
  for (std::size_t k = 0; k < assessment.trackers.size(); ++k) {
    const ScoredTracker& tracker = assessment.trackers[k];
    if (!tracker.overall) continue;
    Series series{.name = tracker.name, .style = plot::style_of(k)};
    for (std::size_t j = 0; const double value : (*tracker.overall).*values)
      series.add(static_cast<double>(j++) * step, value);
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
    for (std::size_t j = 1; j < values.size(); ++j) series.add(static_cast<double>(j), values[j]);
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

Plot bins_plot(const Assessment& assessment,
               const std::string& key,
               const std::string& x,
               plot::Mark mark = plot::Mark::kLineAndPoints) {
  // Of trackers that differ in their frames, those of the one with the most.
  std::map<statistics::Place, std::int64_t> frames;
  for (const ScoredTracker& tracker : assessment.trackers)
    if (const auto found = tracker.bins.find(key); found != tracker.bins.end())
      for (const measures::Bin& bin : found->second)
        frames[bin.place] = std::max(frames[bin.place], bin.frames);
  Plot plot{.x = {.label = x + " (frames)"}, .y = {.label = "mean overlap", .min = 0}};
  for (const auto& [place, most] : frames)
    plot.x.names.push_back(report::counted_place(
        key == kBackground ? place.name : plot::name_of_bin(place.from, place.to),
        static_cast<double>(most)));
  for (std::size_t k = 0; k < assessment.trackers.size(); ++k) {
    const auto found = assessment.trackers[k].bins.find(key);
    if (found == assessment.trackers[k].bins.end() || found->second.empty()) continue;
    Series series{.name = assessment.trackers[k].name, .mark = mark, .style = plot::style_of(k)};
    for (const measures::Bin& bin : found->second)
      series.add(static_cast<double>(std::distance(frames.begin(), frames.find(bin.place))),
                 bin.overlap);
    plot.series.push_back(std::move(series));
  }
  return plot;
}

// The run of a tracker (index in assessment.trackers) on a sequence (index in assessment.truths);
// nullptr if it was not run.
const ScoredSequence* scored_sequence(const Assessment& assessment,
                                      std::size_t tracker,
                                      std::size_t truth) {
  for (const ScoredSequence& sequence : assessment.trackers[tracker].sequences)
    if (sequence.truth == truth && sequence.score) return &sequence;
  return nullptr;
}

// success, precision, normalised, eao, range_m, size_px, contrast, background and the weather:
// those of them for which the assessment holds values. Every tracker has one style in all of them.
std::vector<report::NamedPlot> evaluation_plots(const Assessment& assessment) {
  using evaluation::Score;
  std::vector<report::NamedPlot> plots = {
      {"success", curve(assessment, "overlap", 0.05, &Score::success)},
      {"precision", curve(assessment, "centre error, px", 1, &Score::precision)},
      {"normalised", curve(assessment, "centre error over size", 0.01, &Score::normalised)},
      {"eao", eao_plot(assessment)},
      {"range_m", bins_plot(assessment, "range_m", "range, m")},
      {"size_px", bins_plot(assessment, "size_px", "box size (longer side), px")},
      {"contrast", bins_plot(assessment, "contrast", "contrast, levels of 255")},
      {kBackground, bins_plot(assessment, kBackground, kBackground, plot::Mark::kBars)}};
  for (const auto& [key, edges] : statistics::kWeatherEdges)
    plots.push_back({key, bins_plot(assessment, key, key)});
  return report::with_data(std::move(plots));
}

// The mean AUC of each tracker with its 95 % interval over sequences, the best on top. Without
// series if no tracker has a one-pass run.
Plot ranking_plot(const Assessment& assessment) {
  std::vector<report::Ranked> trackers;
  for (const ScoredTracker& tracker : assessment.trackers)
    if (tracker.overall)
      trackers.push_back({tracker.name, *tracker.overall->auc, tracker.intervals.at("auc")});
  return report::ranking_plot("AUC", trackers);
}

// X, Y and the error of the centre over the frames of assessment.truths[index], in px, as in Figure
// 11 of the E-Vision paper.
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
    for (std::size_t i = 0; i < frames.size(); ++i)
      series.add(static_cast<double>(frames[i].frame), value(i));
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

using report::Json;
using report::list_of;

// Boxes on the page, of all sequences and trackers together: 25 bytes each.
constexpr std::size_t kMaxBoxes = 1'000'000;

// To hundredths, so that it prints short.
double short_of(double value) { return std::stod(fmt::format("{:.2f}", value)); }

Json box_json(const std::optional<Box>& box) {
  if (!box || !std::isfinite(box->x + box->y + box->width + box->height)) return Json();
  return {short_of(box->x), short_of(box->y), short_of(box->width), short_of(box->height)};
}

// Every so many frames, and those that have a picture.
std::vector<std::size_t> shown_frames(const TruthClip& truth, std::size_t step) {
  std::set<std::size_t> shown;
  for (std::size_t i = 0; i < truth.clip.frames.size(); i += step) shown.insert(i);
  for (const drawing::Still& still : truth.stills) shown.insert(still.index);
  return {shown.begin(), shown.end()};
}

Json stills_json(const TruthClip& truth, const std::vector<std::size_t>& shown) {
  Json stills = Json::array();
  for (std::size_t k = 0; k < truth.stills.size(); ++k) {
    const drawing::Still& still = truth.stills[k];
    const auto at = std::lower_bound(shown.begin(), shown.end(), still.index) - shown.begin();
    stills.push_back({{"number", k},
                      {"at", at},
                      {"close_x", still.close.x},
                      {"close_y", still.close.y},
                      {"close_px", still.close.px}});
  }
  return stills;
}

Json tracker_json(const ScoredSequence& sequence,
                  std::size_t tracker,
                  const std::vector<std::size_t>& shown) {
  const Json facts = json_of(sequence);
  Json json = {{"tracker", tracker}};
  for (const char* key : {"auc", "precision_20px", "angle_mrad", "first_loss"})
    json[key] = facts.at(key);
  json["boxes"] = list_of(shown, [&](std::size_t i) { return box_json(sequence.answers[i]); });
  return json;
}

Json sequence_json(const Assessment& assessment, std::size_t index, std::size_t step) {
  const TruthClip& truth = assessment.truths[index];
  const std::vector<std::size_t> shown = shown_frames(truth, step);
  const auto range = [&](std::size_t i) {
    const std::optional<double> range_m = truth.range_m(i);
    return range_m ? Json(short_of(*range_m)) : Json();
  };
  Json trackers = Json::array();
  for (std::size_t k = 0; k < assessment.trackers.size(); ++k)
    if (const ScoredSequence* sequence = scored_sequence(assessment, k, index))
      trackers.push_back(tracker_json(*sequence, k, shown));
  return {{"name", truth.clip.name},
          {"background", truth.background},
          {"frames", truth.clip.frames.size()},
          {"width", std::max(1, truth.clip.width)},
          {"height", std::max(1, truth.clip.height)},
          {"frame", list_of(shown, [&](std::size_t i) { return truth.clip.frames[i].frame; })},
          {"range_m", list_of(shown, range)},
          {"truth", list_of(shown, [&](std::size_t i) { return box_json(truth.box(i)); })},
          {"stills", stills_json(truth, shown)},
          {"trackers", trackers}};
}

Json trackers_json(const Assessment& assessment) {
  Json trackers = Json::array();
  for (std::size_t k = 0; k < assessment.trackers.size(); ++k) {
    const ScoredTracker& tracker = assessment.trackers[k];
    Json json = json_of(tracker);
    json["style"] = plot::json_of(plot::style_of(k));
    json["sequences"] = std::ranges::count_if(
        tracker.sequences, [](const ScoredSequence& s) { return s.score.has_value(); });
    trackers.push_back(json);
  }
  return trackers;
}

// The pictures of all sequences, under the names by which the page finds them.
std::vector<html::PagePicture> pictures_of(const Assessment& assessment) {
  std::vector<html::PagePicture> pictures;
  for (std::size_t i = 0; i < assessment.truths.size(); ++i)
    for (std::size_t k = 0; k < assessment.truths[i].stills.size(); ++k)
      drawing::add_still(pictures, i, k, assessment.truths[i].stills[k]);
  return pictures;
}

// Truth on pictures is white with a dark rim.
constexpr plot::Colour kTruthOnPictures = {255, 255, 255};
// Numbers of pictures of a sequence, spread over it, and of those that stand side by side.
constexpr std::size_t kFilmPictures = 6;
constexpr int kFilmColumns = 3;
// Pictures of a sequence with the boxes of truth and trackers.
void write_film(const Assessment& assessment, std::size_t index, const fs::path& folder) {
  const TruthClip& truth = assessment.truths[index];
  if (truth.stills.empty()) return;
  std::vector<drawing::NamedPicture> pictures;
  for (const std::size_t at : drawing::spread_over(truth.stills.size(), kFilmPictures)) {
    const drawing::Still& still = truth.stills[at];
    std::vector<drawing::ColouredBox> boxes;
    if (const auto box = truth.box(still.index)) boxes.push_back({*box, kTruthOnPictures});
    for (std::size_t t = 0; t < assessment.trackers.size(); ++t)
      if (const ScoredSequence* sequence = scored_sequence(assessment, t, index))
        if (const auto& box = sequence->answers[still.index])
          boxes.push_back({*box, plot::style_of(t).colour});
    const double scale =
        std::min(1.0, static_cast<double>(kClose.whole_width) / std::max(1, still.width));
    pictures.push_back({fmt::format("frame {}", truth.clip.frames[still.index].frame),
                        drawing::boxed(still.whole, scale, boxes)});
  }
  video::write_still(folder / ("frames-" + truth.clip.name + ".png"),
                     drawing::tiled(truth.clip.name, pictures, kFilmColumns));
}

}  // namespace

void write_page(const Assessment& assessment, const fs::path& out) {
  std::size_t frames = 0;
  for (const TruthClip& truth : assessment.truths) frames += truth.clip.frames.size();
  const std::size_t step = 1 + frames * (assessment.trackers.size() + 1) / kMaxBoxes;
  Json data = {{"dataset", assessment.set},
               {"version", kVersion},
               {"frames", frames},
               {"eao_range", {assessment.eao_range.first, assessment.eao_range.second}},
               {"plots", report::json_of(evaluation_plots(assessment))},
               {"trackers", trackers_json(assessment)},
               {"comparisons",
                list_of(assessment.comparisons, [](const auto& one) { return json_of(one); })},
               {"sequences", Json::array()}};
  for (std::size_t i = 0; i < assessment.truths.size(); ++i)
    data["sequences"].push_back(sequence_json(assessment, i, step));
  write_file(out / "report.html",
             html::page_of("airtruth evaluation",
                           html::evaluation_body(),
                           data.dump(-1, ' ', false, Json::error_handler_t::replace),
                           pictures_of(assessment),
                           html::evaluation_js()));
}

void write_figures(const Assessment& assessment, const fs::path& out, const std::string& format) {
  const report::Figures figures(out, "", format);
  figures.draw(evaluation_plots(assessment));
  figures.draw_ranking(ranking_plot(assessment));
  for (std::size_t i = 0; i < assessment.truths.size(); ++i) {
    figures.draw_column(sequence_plots(assessment, i), "xy-" + assessment.truths[i].clip.name);
    write_film(assessment, i, figures.folder());
  }
}

}  // namespace airtruth::tracker_evaluation
