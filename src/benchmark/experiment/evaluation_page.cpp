// SPDX-License-Identifier: Apache-2.0
#include "benchmark/experiment/evaluation_page.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <airtruth/version.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "benchmark/experiment/evaluation_plots.h"
#include "benchmark/experiment/evaluation_tables.h"
#include "foundation/base/base64.h"
#include "foundation/base/files.h"
#include "show/html/page.h"
#include "show/html/page_assets.h"
#include "show/plot/plot_json.h"

namespace airtruth::experiment {
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
                      {"close_x", still.close_x},
                      {"close_y", still.close_y},
                      {"close_px", still.close_px}});
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

Json plots_json(const Assessment& assessment) {
  Json plots = Json::object();
  for (const auto& [name, plot] : evaluation_plots(assessment)) plots[name] = plot::json_of(plot);
  return plots;
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
      pictures.push_back({fmt::format("whole-{}-{}", i, k), base64_of(stills[k].whole)});
      if (!stills[k].close.empty())
        pictures.push_back({fmt::format("close-{}-{}", i, k), base64_of(stills[k].close)});
    }
  }
  return pictures;
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
               {"plots", plots_json(assessment)},
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

}  // namespace airtruth::experiment
