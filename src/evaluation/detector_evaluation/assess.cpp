// SPDX-License-Identifier: Apache-2.0
#include "evaluation/detector_evaluation/assess.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "evaluation/detector_evaluation/set_truth.h"
#include "evaluation/report/tables.h"
#include "evaluation/scores/detector_score.h"
#include "foundation/base/error.h"
#include "foundation/base/in_parallel.h"
#include "foundation/base/text.h"
#include "foundation/json/json_object.h"
#include "foundation/json/settings_record.h"
#include "runners/results/results_folder.h"

namespace airtruth::detector_evaluation {
namespace {

std::vector<scores::ScoredDetections> results_in(
    const fs::path& source,
    const std::vector<scores::TruthSequence>& truths,
    std::span<const results::ExpectedSequence> expected,
    const Warn& warn) {
  std::map<std::string, std::size_t> numbers;
  for (std::size_t i = 0; i < truths.size(); ++i) numbers[truths[i].name] = i;
  std::vector<scores::ScoredDetections> results;
  std::vector<std::string> of_other_content;
  for (results::SequenceDetections& read : results::read_detections(source, expected, warn)) {
    const std::size_t truth = numbers.at(read.name);
    if (read.frames.size() != truths[truth].frames.size())
      throw Error(fmt::format("holds {} frames of '{}'; the data set has {}",
                              read.frames.size(),
                              read.name,
                              truths[truth].frames.size()),
                  {source.string()});
    if (!read.source_sha256.empty() && read.source_sha256 != truths[truth].sha256)
      of_other_content.push_back(read.name);
    results.push_back({truth, std::move(read), {}});
  }
  if (results.empty())
    throw Error("holds no detections of any sequence of the data set", {source.string()});
  if (results.size() < truths.size())
    airtruth::warn(warn,
                   fmt::format("{}: has results for {} of {} sequences; its measures are of those",
                               source.string(),
                               results.size(),
                               truths.size()));
  report::warn_of_other_content(source, of_other_content, "detect", warn);
  return results;
}

// `airtruth detect --associate` records how it made tracks, of which there may be none.
bool is_associated(const fs::path& source) {
  const fs::path record = source / "detector.json";
  return fs::exists(record) && JsonDocument(record).has("association");
}

struct Results {
  bool is_associated = false;
  std::vector<scores::ScoredDetections> sequences;
};

// By name, each detector's results.
using AllResults = std::map<std::string, Results>;

// Videos of sequences without results are not read.
void add_films(std::vector<scores::TruthSequence>& truths,
               const AllResults& found,
               const AssessOptions& options) {
  std::set<std::size_t> with_results;
  for (const auto& [name, results] : found)
    for (const scores::ScoredDetections& one : results.sequences) with_results.insert(one.truth);
  const std::vector<std::size_t> wanted(with_results.begin(), with_results.end());
  in_parallel(wanted.size(), options, [&](std::size_t i) {
    measure_contrast(truths[wanted[i]], options.stop);
  });
}

// Comparisons with a limit let NaN pass.
void expect_number(const char* option, const std::optional<double>& value) {
  if (value && !std::isfinite(*value))
    throw Error(std::string(option) + " is not a number; expected a finite one");
}

void check_options(const AssessOptions& options) {
  expect_number("--centre-px", options.centre_px);
  expect_number("--score", options.score);
  expect_number("--false-alarms", options.false_alarms_per_image);
  expect_number("--manoeuvre-s", options.manoeuvre_s);
  if (options.manoeuvre_s && options.volume.empty())
    throw Error("--manoeuvre-s needs --volume: the volume that the manoeuvre is to avoid");
}

void say_who_has_no_tracks(scores::Assessment& assessment) {
  for (const scores::DetectorScore& detector : assessment.detectors)
    if (!detector.tracks)
      assessment.left_out.push_back(
          detector.name +
          " reports no tracks; declarations, false tracks, HOTA, CLEAR and Identity leave it out "
          "(`airtruth detect --associate` makes tracks)");
}

}  // namespace

scores::Assessment assess(const fs::path& set,
                          const std::vector<fs::path>& results,
                          const AssessOptions& options) {
  check_options(options);
  scores::Assessment assessment;
  assessment.set = report::name_of_results(set);
  assessment.options = options;
  for (const sequences::Condition& one : options.where) assessment.where.push_back(one.text);
  SetTruth truth = set_truth(set, options.volume, options.ignore);
  assessment.truths = std::move(truth.sequences);
  assessment.options.is_weighted = truth.is_weighted;
  assessment.left_out = std::move(truth.left_out);
  // Results are read first, so that their faults are reported before minutes of video are read.
  AllResults found;
  for (const fs::path& source : results) {
    const std::string name = report::name_of_results(source);
    if (found.contains(name))
      throw Error("is the second set of results called '" + name + "'", {source.string()});
    check_record(source / "detector.json");
    Results& of = found[name];
    of = {is_associated(source),
          results_in(source, assessment.truths, truth.expected, options.warn)};
    std::erase_if(of.sequences, [&](const scores::ScoredDetections& one) {
      return !sequences::hold(options.where, assessment.truths[one.truth].weather);
    });
    if (of.sequences.empty())
      throw Error("holds no detections of any sequence for which --where holds", {source.string()});
  }
  if (options.with_film) add_films(assessment.truths, found, options);
  std::vector<std::string> names;
  for (const auto& [name, of] : found) names.push_back(name);
  assessment.detectors.resize(names.size());
  in_parallel(
      names.size(),
      options.jobs,
      [&](std::size_t i) {
        Results& of = found.at(names[i]);
        assessment.detectors[i] = scores::score_detector(names[i],
                                                         std::move(of.sequences),
                                                         of.is_associated,
                                                         assessment.truths,
                                                         assessment.options);
      },
      {},
      options.stop);
  std::ranges::stable_sort(
      assessment.detectors, std::greater(), [](const scores::DetectorScore& one) {
        return one.average_precision.ap_centre.value_or(-1);
      });
  say_who_has_no_tracks(assessment);
  for (const std::string& sentence : assessment.left_out) airtruth::warn(options.warn, sentence);
  return assessment;
}

namespace {

bool has_ending(const fs::path& file, const char* ending) {
  return file.extension() == ending && fs::is_regular_file(file);
}

enum class Text { kEmpty, kMotOfDetector, kOther };

// MOTChallenge's lines have an id as their second cell of seven or more, between commas, blanks or
// tabs; a detection without a track has the id -1.
Text text_of(const fs::path& file, bool with_tracks) {
  std::ifstream text(file);
  std::string line;
  while (std::getline(text, line)) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::ranges::replace_if(
        line, [](char c) { return c == ',' || c == '\t' || c == '\r'; }, ' ');
    const std::vector<std::string> cells = words_in(line);
    if (cells.size() < 7) return Text::kOther;
    const bool has_no_track = number_from_text<double>(cells[1]) == -1;
    return with_tracks || has_no_track ? Text::kMotOfDetector : Text::kOther;
  }
  return Text::kEmpty;
}

}  // namespace

bool holds_detections(const fs::path& results, bool is_mot_of_detector) {
  std::error_code failed;
  if (has_ending(results, ".json")) return true;
  if (!fs::is_directory(results, failed) || fs::exists(results / "tracker.json")) return false;
  if (fs::exists(results / "detector.json")) return true;
  std::size_t json = 0;
  bool has_det = false;
  bool has_folder = false;
  std::vector<fs::path> texts;
  for (const fs::path& folder : {results, results / "data"})
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
      json += has_ending(entry.path(), ".json") ? 1 : 0;
      if (has_ending(entry.path(), ".txt")) texts.push_back(entry.path());
      has_det = has_det || fs::exists(entry.path() / "det" / "det.txt", failed);
      has_folder = has_folder || entry.is_directory(failed);
    }
  if (has_det || (json == 1 && texts.empty() && !has_folder)) return true;
  std::erase_if(texts,
                [](const fs::path& file) { return file.stem().string().ends_with("_time"); });
  std::vector<Text> kinds;
  for (const fs::path& file : texts) kinds.push_back(text_of(file, is_mot_of_detector));
  // A detector that detects nothing leaves empty files; a tracker has a line for each frame.
  const auto of = [&](Text kind) { return std::count(kinds.begin(), kinds.end(), kind); };
  return of(Text::kMotOfDetector) > 0 || (!texts.empty() && of(Text::kEmpty) == std::ssize(texts));
}

}  // namespace airtruth::detector_evaluation
