// SPDX-License-Identifier: Apache-2.0
#include "evaluation/detector_evaluation/page.h"

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include <airtruth/version.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "evaluation/detector_evaluation/plots.h"
#include "evaluation/detector_evaluation/tables.h"
#include "evaluation/report/tables.h"
#include "foundation/base/files.h"
#include "foundation/base/in_parallel.h"
#include "foundation/json/or_null.h"
#include "picture/video/numbered_frames.h"
#include "show/drawing/thumbnails.h"
#include "show/html/page.h"
#include "show/plot/plot.h"

namespace airtruth::detector_evaluation {
namespace {

using report::Json;
using report::list_of;

// The pictures of a page. Empty films and cutouts: the sequence's video is not known.
struct Film {
  // As scores::Assessment::truths. The subject of a still is the aircraft that counts and is
  // largest, else the strongest detection of the first detector.
  std::vector<std::vector<drawing::Still>> sequences;
  // As DetectorScore::false_alarms and misses of each detector.
  std::vector<std::vector<drawing::Cutout>> false_alarms, misses;
};

// Stills of all sequences together, some 25 kB each, and of one sequence.
constexpr std::size_t kMaxStills = 1000;
constexpr std::size_t kLeastStills = 2;
constexpr std::size_t kMostStills = 60;

// A cutout to be made, and where it goes.
struct Wanted {
  Box box;
  drawing::Cutout* place = nullptr;
};

// What is shown of each frame of one sequence.
struct Plan {
  std::set<std::size_t> stills;
  std::map<std::size_t, std::vector<Wanted>> cutouts;
};

// The cutouts of both galleries, and the stills.
std::vector<Plan> plans_of(const scores::Assessment& assessment, Film& film) {
  std::vector<Plan> plans(assessment.truths.size());
  film.false_alarms.resize(assessment.detectors.size());
  film.misses.resize(assessment.detectors.size());
  for (std::size_t k = 0; k < assessment.detectors.size(); ++k) {
    const scores::DetectorScore& detector = assessment.detectors[k];
    const auto add = [&](const auto& entries, std::vector<drawing::Cutout>& cutouts) {
      cutouts.resize(entries.size());
      for (std::size_t i = 0; i < entries.size(); ++i)
        plans[detector.sequences[entries[i].sequence].truth].cutouts[entries[i].frame].push_back(
            {entries[i].box_px, &cutouts[i]});
    };
    add(detector.false_alarms, film.false_alarms[k]);
    add(detector.misses, film.misses[k]);
  }
  // Sequences without results are not shown.
  std::set<std::size_t> with_results;
  for (const scores::DetectorScore& detector : assessment.detectors)
    for (const scores::ScoredDetections& scored : detector.sequences)
      with_results.insert(scored.truth);
  const std::size_t of_one = std::clamp(
      kMaxStills / std::max<std::size_t>(1, with_results.size()), kLeastStills, kMostStills);
  for (const std::size_t i : with_results) {
    const std::size_t frames = assessment.truths[i].frames.size();
    plans[i].stills = drawing::spread_over(frames, of_one);
    for (const auto& [frame, cutouts] : plans[i].cutouts)
      if (plans[i].stills.size() < 2 * of_one) plans[i].stills.insert(frame);
  }
  return plans;
}

// What the close-up of a still is around.
std::optional<Box> subject_of(const scores::Assessment& assessment,
                              std::size_t truth,
                              std::size_t frame) {
  std::optional<Box> subject;
  double largest = 0;
  for (const scores::TruthObject& object : assessment.truths[truth].frames[frame].objects)
    if (object.is_aircraft() && object.counts && object.size_px() > largest) {
      largest = object.size_px();
      subject = object.box_px;
    }
  if (subject) return subject;
  for (const scores::DetectorScore& detector : assessment.detectors)
    for (const scores::ScoredDetections& scored : detector.sequences) {
      if (scored.truth != truth || frame >= scored.detections.frames.size()) continue;
      const auto& found = scored.detections.frames[frame];
      const auto strongest = std::ranges::max_element(found, {}, &results::Detection::score);
      if (strongest != found.end()) return strongest->box_px;
    }
  return std::nullopt;
}

std::vector<drawing::Still> read_film(const scores::Assessment& assessment,
                                      std::size_t truth,
                                      const Plan& plan,
                                      const std::stop_token& stop) {
  const scores::TruthSequence& sequence = assessment.truths[truth];
  std::vector<drawing::Still> stills;
  if (sequence.media.empty()) return stills;
  video::NumberedFrames pictures(sequence.media, {});
  std::set<std::size_t> frames = plan.stills;
  for (const auto& [frame, cutouts] : plan.cutouts) frames.insert(frame);
  for (const std::size_t i : frames) {
    const image::Picture& picture =
        pictures.labelled(sequence.frames[i].frame, sequence.name, stop);
    if (plan.stills.contains(i))
      stills.push_back(drawing::still_of(picture, i, subject_of(assessment, truth, i), {}));
    if (const auto cutouts = plan.cutouts.find(i); cutouts != plan.cutouts.end())
      for (const Wanted& wanted : cutouts->second)
        *wanted.place = drawing::cutout_of(picture, wanted.box, {});
  }
  return stills;
}

// Reads the video of each sequence with results once, as far as its last frame that is shown.
// Stills are spread over a sequence; the frames of its false alarms and misses are among them while
// there is room. Throws Error where a video ends before a frame that it should show.
Film film_of(const scores::Assessment& assessment, const report::RunOptions& run) {
  Film film;
  film.sequences.resize(assessment.truths.size());
  const std::vector<Plan> plans = plans_of(assessment, film);
  std::vector<std::size_t> wanted;
  for (std::size_t i = 0; i < plans.size(); ++i)
    if (!plans[i].stills.empty()) wanted.push_back(i);
  in_parallel(wanted.size(), run, [&](std::size_t i) {
    film.sequences[wanted[i]] = read_film(assessment, wanted[i], plans[wanted[i]], run.stop);
  });
  return film;
}

// Of one detector in one frame, the strongest are drawn.
constexpr std::size_t kMaxDrawn = 30;

// Boxes to hundredths, so that they print short.
Json box_json(const Box& box) {
  Json json = Json::array();
  for (const double value : {box.x, box.y, box.width, box.height})
    json.push_back(std::stod(fmt::format("{:.2f}", value)));
  return json;
}

// What the plots show is not repeated in the detectors' own numbers.
Json detector_json(const scores::Assessment& assessment, std::size_t k) {
  Json json = json_of_detector(assessment.detectors[k], assessment);
  json.erase("by");
  json.erase("mistaken_by");
  json["froc"].erase("points");
  for (const char* curve : {"curve_50", "curve_centre"}) json["average_precision"].erase(curve);
  if (json["tracks"].is_object()) {
    json["tracks"].erase("operating_curve");
    for (const char* part : {"hota", "clear", "identity"})
      for (auto& [key, value] : json["tracks"][part].items())
        if (value.is_object()) value.erase("at_overlaps");
  }
  json["style"] = plot::json_of(plot::style_of(k));
  return json;
}

// A letter for each frame: f where every aircraft that counts is found at the operating point, p
// where some are, m where none is, . where there is none.
std::string found_letters(const scores::TruthSequence& truth,
                          const scores::ScoredDetections& scored,
                          double score) {
  std::string letters(truth.frames.size(), '.');
  scores::each_aircraft(
      truth, scored, [&](std::size_t i, std::size_t, const results::Detection* best) {
        const char own = best != nullptr && best->score >= score ? 'f' : 'm';
        char& letter = letters[i];
        letter = letter == '.' || letter == own ? own : 'p';
      });
  return letters;
}

// The frames with a false alarm at the operating point, as indices.
Json false_alarm_frames(const scores::ScoredDetections& scored, double score) {
  Json frames = Json::array();
  scored.each([&](std::size_t i, const results::Detection& detection, const scores::Match& match) {
    if (match.kind == scores::MatchKind::kFalseAlarm && detection.score >= score &&
        (frames.empty() || frames.back() != i))
      frames.push_back(i);
  });
  return frames;
}

Json detections_in(const scores::ScoredDetections& scored, std::size_t frame) {
  Json json = Json::array();
  if (frame >= scored.detections.frames.size()) return json;
  const auto& found = scored.detections.frames[frame];
  std::vector<std::size_t> order(found.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater(), [&](std::size_t i) { return found[i].score; });
  order.resize(std::min(order.size(), kMaxDrawn));
  for (const std::size_t i : order) {
    const scores::Match& match = scored.matches[frame][i];
    json.push_back({box_json(found[i].box_px),
                    found[i].score,
                    found[i].track ? Json(*found[i].track) : Json(),
                    enum_name(match.kind),
                    match.what});
  }
  return json;
}

Json object_json(const scores::TruthObject& object) {
  return {{"id", object.id},
          {"class", object.object_class},
          {"counts", object.counts},
          {"box", box_json(object.box_px)},
          {"range_m", rounded(object.range_m, 0.1)},
          {"cnr", rounded(object.contrast_to_noise, 0.01)},
          {"to_closest_s", rounded(object.to_closest_approach_s, 0.01)}};
}

Json cutout_json(const drawing::Cutout& cutout) {
  return cutout.jpeg.empty() ? Json() : Json{cutout.x, cutout.y, cutout.px};
}

Json still_json(const scores::TruthSequence& truth, const drawing::Still& still) {
  const scores::TruthFrame& frame = truth.frames[still.index];
  return {{"index", still.index},
          {"frame", frame.frame},
          {"time_s", truth.has_times ? Json(rounded(frame.time_s, 0.001)) : Json()},
          {"close", cutout_json(still.close)},
          {"objects", list_of(frame.objects, object_json)},
          {"ignored", list_of(frame.ignored_px, box_json)}};
}

Json encounter_json(const scores::TruthEncounter& one) {
  return {{"id", one.id},
          {"name", one.name},
          {"closest_s", rounded(one.closest_approach_s, 0.001)},
          {"closest_m", rounded(one.closest_approach_m, 0.01)},
          {"violation_s", rounded(one.violation_s, 0.001)}};
}

Json sequence_json(const scores::Assessment& assessment, const Film& film, std::size_t index) {
  const scores::TruthSequence& truth = assessment.truths[index];
  const std::vector<drawing::Still>& stills = film.sequences[index];
  Json detectors = Json::array();
  for (std::size_t k = 0; k < assessment.detectors.size(); ++k) {
    const scores::DetectorScore& detector = assessment.detectors[k];
    for (const scores::ScoredDetections& scored : detector.sequences) {
      if (scored.truth != index) continue;
      const auto drawn = [&](const auto& still) { return detections_in(scored, still.index); };
      detectors.push_back({{"detector", k},
                           {"found", found_letters(truth, scored, detector.point.score)},
                           {"false_alarms", false_alarm_frames(scored, detector.point.score)},
                           {"drawn", list_of(stills, drawn)}});
    }
  }
  return {{"name", truth.name},
          {"background", truth.background},
          {"width", std::max(1, truth.width)},
          {"height", std::max(1, truth.height)},
          {"weight", truth.weight.value_or(1)},
          {"frame", list_of(truth.frames, std::mem_fn(&scores::TruthFrame::frame))},
          {"encounters", list_of(truth.encounters, encounter_json)},
          {"stills", list_of(stills, [&](const auto& one) { return still_json(truth, one); })},
          {"detectors", detectors}};
}

// Where the cutouts of the galleries lie in their frames, beside the entries of json_of.
void add_cutouts(const Film& film, std::size_t k, Json& detector) {
  const auto add = [](const std::vector<drawing::Cutout>& cutouts, Json& entries) {
    for (std::size_t i = 0; i < cutouts.size(); ++i) entries[i]["cutout"] = cutout_json(cutouts[i]);
  };
  add(film.false_alarms[k], detector["strongest_false_alarms"]);
  add(film.misses[k], detector["misses"]);
}

// All pictures, under the names by which the page finds them.
std::vector<html::PagePicture> pictures_of(const Film& film) {
  std::vector<html::PagePicture> pictures;
  for (std::size_t i = 0; i < film.sequences.size(); ++i)
    for (std::size_t k = 0; k < film.sequences[i].size(); ++k)
      drawing::add_still(pictures, i, k, film.sequences[i][k]);
  for (std::size_t k = 0; k < film.misses.size(); ++k) {
    for (std::size_t i = 0; i < film.false_alarms[k].size(); ++i)
      pictures.push_back({fmt::format("alarm-{}-{}", k, i), film.false_alarms[k][i].jpeg});
    for (std::size_t i = 0; i < film.misses[k].size(); ++i)
      pictures.push_back({fmt::format("miss-{}-{}", k, i), film.misses[k][i].jpeg});
  }
  return pictures;
}

Json data_of(const scores::Assessment& assessment, const Film& film) {
  std::size_t frames = 0;
  for (const scores::TruthSequence& truth : assessment.truths) frames += truth.frames.size();
  Json data = {{"dataset", assessment.set},
               {"version", kVersion},
               {"frames", frames},
               {"centre_px", assessment.options.centre_px},
               {"manoeuvre_s", or_null(assessment.options.manoeuvre_s)},
               {"volume", assessment.options.volume},
               {"is_weighted", assessment.options.is_weighted},
               {"left_out", assessment.left_out},
               {"plots", report::json_of(detection_plots(assessment))},
               {"detectors", Json::array()},
               {"sequences", Json::array()}};
  for (std::size_t k = 0; k < assessment.detectors.size(); ++k) {
    data["detectors"].push_back(detector_json(assessment, k));
    add_cutouts(film, k, data["detectors"].back());
  }
  for (std::size_t i = 0; i < assessment.truths.size(); ++i)
    data["sequences"].push_back(sequence_json(assessment, film, i));
  return data;
}

}  // namespace

void write_page(const scores::Assessment& assessment,
                const fs::path& out,
                const report::RunOptions& run) {
  const Film film = film_of(assessment, run);
  write_file(
      out / "detection.html",
      html::page_of("airtruth evaluation of detectors",
                    html::detection_body(),
                    data_of(assessment, film).dump(-1, ' ', false, Json::error_handler_t::replace),
                    pictures_of(film),
                    std::string(html::detection_player_js()) + std::string(html::detection_js())));
}

void write_figures(const scores::Assessment& assessment,
                   const fs::path& out,
                   const std::string& format) {
  const report::Figures figures(out, "detection_", format);
  figures.draw(detection_plots(assessment));
  figures.draw_ranking(ranking_plot(assessment));
}

}  // namespace airtruth::detector_evaluation
