// SPDX-License-Identifier: Apache-2.0
#include "evaluation/tracker_evaluation/page.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <airtruth/version.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "evaluation/tracker_evaluation/plots.h"
#include "evaluation/tracker_evaluation/tables.h"
#include "foundation/base/files.h"
#include "picture/video/still.h"
#include "show/drawing/boxed.h"
#include "show/drawing/tiles.h"
#include "show/html/page.h"
#include "show/html/page_assets.h"
#include "show/plot/plot_json.h"

namespace airtruth::tracker_evaluation {
namespace {

using Json = nlohmann::ordered_json;

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
  for (const TruthClip::Still& still : truth.stills) shown.insert(still.index);
  return {shown.begin(), shown.end()};
}

Json stills_json(const TruthClip& truth, const std::vector<std::size_t>& shown) {
  Json stills = Json::array();
  for (std::size_t k = 0; k < truth.stills.size(); ++k) {
    const TruthClip::Still& still = truth.stills[k];
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
  Json boxes = Json::array();
  for (const std::size_t i : shown) boxes.push_back(box_json(sequence.answers[i]));
  json["boxes"] = boxes;
  return json;
}

Json sequence_json(const Assessment& assessment, std::size_t index, std::size_t step) {
  const TruthClip& truth = assessment.truths[index];
  const std::vector<std::size_t> shown = shown_frames(truth, step);
  Json frame = Json::array();
  Json range = Json::array();
  Json boxes = Json::array();
  for (const std::size_t i : shown) {
    frame.push_back(truth.clip.frames[i].frame);
    range.push_back(truth.range_m[i] ? Json(short_of(*truth.range_m[i])) : Json());
    boxes.push_back(box_json(truth.box(i)));
  }
  Json trackers = Json::array();
  for (std::size_t k = 0; k < assessment.trackers.size(); ++k)
    for (const ScoredSequence& sequence : assessment.trackers[k].sequences)
      if (sequence.truth == index && sequence.score)
        trackers.push_back(tracker_json(sequence, k, shown));
  return {{"name", truth.clip.name},
          {"background", truth.background},
          {"frames", truth.clip.frames.size()},
          {"width", std::max(1, truth.clip.width)},
          {"height", std::max(1, truth.clip.height)},
          {"frame", frame},
          {"range_m", range},
          {"truth", boxes},
          {"stills", stills_json(truth, shown)},
          {"trackers", trackers}};
}

Json trackers_json(const Assessment& assessment) {
  Json trackers = Json::array();
  for (std::size_t k = 0; k < assessment.trackers.size(); ++k) {
    const ScoredTracker& tracker = assessment.trackers[k];
    Json json = json_of(tracker);
    json["style"] = plot::json_of(plot::style_of(k));
    json["sequences"] = std::count_if(tracker.sequences.begin(),
                                      tracker.sequences.end(),
                                      [](const ScoredSequence& s) { return s.score.has_value(); });
    trackers.push_back(json);
  }
  return trackers;
}

// The pictures of all sequences, under the names by which the page finds them.
std::vector<html::PageBlob> pictures_of(const Assessment& assessment) {
  std::vector<html::PageBlob> pictures;
  for (std::size_t i = 0; i < assessment.truths.size(); ++i) {
    const auto& stills = assessment.truths[i].stills;
    for (std::size_t k = 0; k < stills.size(); ++k) {
      report::add_picture(pictures, fmt::format("whole-{}-{}", i, k), stills[k].whole);
      report::add_picture(pictures, fmt::format("close-{}-{}", i, k), stills[k].close.jpeg);
    }
  }
  return pictures;
}

// Truth on pictures is white with a dark rim.
constexpr plot::Colour kTruthOnPictures = {255, 255, 255};
// Pictures of a sequence, spread over it, and how many of them stand side by side.
constexpr std::size_t kFilmPictures = 6;
constexpr int kFilmColumns = 3;
// Pictures of a sequence with the boxes of truth and trackers.
void write_film(const Assessment& assessment, std::size_t index, const fs::path& folder) {
  const TruthClip& truth = assessment.truths[index];
  if (truth.stills.empty()) return;
  std::vector<drawing::NamedPicture> pictures;
  const std::size_t count = std::min(kFilmPictures, truth.stills.size());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = count > 1 ? k * (truth.stills.size() - 1) / (count - 1) : 0;
    const TruthClip::Still& still = truth.stills[at];
    std::vector<drawing::ColouredBox> boxes;
    if (const auto box = truth.box(still.index)) boxes.push_back({*box, kTruthOnPictures});
    for (std::size_t t = 0; t < assessment.trackers.size(); ++t)
      if (const ScoredSequence* sequence = scored_sequence(assessment, t, index))
        if (const auto& box = sequence->answers[still.index])
          boxes.push_back({*box, plot::style_of(t).colour});
    const double scale =
        std::min(1.0, static_cast<double>(TruthClip::kWholeWidth) / std::max(1, still.width));
    pictures.push_back({fmt::format("frame {}", truth.clip.frames[still.index].frame),
                        drawing::boxed(still.whole, scale, boxes)});
  }
  video::write_still(folder / ("frames-" + truth.clip.name + ".png"),
                     drawing::tiled(truth.clip.name, std::move(pictures), kFilmColumns));
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
               {"comparisons", Json::array()},
               {"sequences", Json::array()}};
  for (const TrackerPair& comparison : assessment.comparisons)
    data["comparisons"].push_back(json_of(comparison));
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
