// SPDX-License-Identifier: Apache-2.0
#include "dataset/evaluate.h"

#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/files.h"
#include "base/version.h"
#include "dataset/labelled_set.h"
#include "exchange/exchange.h"
#include "exchange/text.h"

namespace airtruth::dataset {
namespace {

using Json = nlohmann::ordered_json;
using evaluation::Score;

struct Column {
  const char* name;
  double Score::*value;
};
constexpr Column kColumns[] = {{"auc", &Score::auc},
                               {"precision_20px", &Score::precision_20px},
                               {"normalised_auc", &Score::normalised_auc},
                               {"average_overlap", &Score::average_overlap},
                               {"success_50", &Score::success_50},
                               {"success_75", &Score::success_75},
                               {"centre_mean_px", &Score::centre_mean_px},
                               {"x_mean_px", &Score::x_mean_px},
                               {"x_rmse_px", &Score::x_rmse_px},
                               {"x_most_px", &Score::x_most_px},
                               {"y_mean_px", &Score::y_mean_px},
                               {"y_rmse_px", &Score::y_rmse_px},
                               {"y_most_px", &Score::y_most_px},
                               {"frames_per_second", &Score::frames_per_second}};

std::map<std::string, exchange::Clip> truths_of(const LabelledSet& set) {
  std::map<std::string, exchange::Clip> truths;
  for (const std::string& name : set.names())
    for (exchange::Clip& clip : exchange::arranged(exchange::Format::kOtb, set.clip(name)))
      truths[clip.name] = std::move(clip);
  return truths;
}

std::vector<std::optional<Box>> answers_of(const fs::path& file, int origin_px) {
  std::vector<std::optional<Box>> answers;
  for (const exchange::Line& line : exchange::lines_of(file)) {
    const std::vector<double> n = exchange::numbers_of(line, file);
    if (n.size() != 4)
      throw Error(fmt::format("has {} numbers; expected x,y,width,height", n.size()),
                  {file.string(), line.number});
    const Box box{n[0] - origin_px, n[1] - origin_px, n[2], n[3]};
    const bool sound =
        std::isfinite(box.x + box.y + box.width + box.height) && box.width > 0 && box.height > 0;
    answers.push_back(sound ? std::optional(box) : std::nullopt);
  }
  return answers;
}

std::vector<double> times_of(const fs::path& file, std::size_t frames) {
  std::vector<double> times;
  if (fs::exists(file))
    for (const exchange::Line& line : exchange::lines_of(file))
      for (const double value : exchange::numbers_of(line, file)) times.push_back(value);
  times.resize(frames, 0);
  return times;
}

std::string lengths(std::size_t lines, const exchange::Clip& clip) {
  return fmt::format(
      "has {} lines; {} has {} frames from the first that shows its object to the last",
      lines,
      clip.name,
      clip.frames.size());
}

Score score_of(const fs::path& file, const exchange::Clip& clip, int origin_px) {
  const auto answers = answers_of(file, origin_px);
  if (answers.size() != clip.frames.size())
    throw Error(lengths(answers.size(), clip), {file.string()});
  const std::vector<double> times =
      times_of(file.parent_path() / (file.stem().string() + "_time.txt"), answers.size());
  std::vector<evaluation::FramePair> frames;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const auto& labels = clip.frames[i].labels;
    frames.push_back({labels.empty() ? std::nullopt : std::optional(labels.front().box_px),
                      answers[i],
                      times[i]});
  }
  return evaluation::score(frames, clip.width, clip.height);
}

ScoredTracker scored(const fs::path& folder,
                     const std::map<std::string, exchange::Clip>& truths,
                     int origin_px,
                     const Warn& warn) {
  const fs::path plain = fs::absolute(folder).lexically_normal();
  ScoredTracker tracker;
  tracker.name = (plain.has_filename() ? plain : plain.parent_path()).filename().string();
  std::set<std::string> unknown;
  for (const fs::path& file : exchange::files_with(folder, ".txt")) {
    const std::string name = file.stem().string();
    const auto truth = truths.find(name);
    if (truth != truths.end())
      tracker.sequences.push_back({name, score_of(file, truth->second, origin_px)});
    else if (!name.ends_with("_time"))
      unknown.insert(name);
  }
  if (tracker.sequences.empty())
    throw Error("holds no result for any sequence of the data set; expected SEQUENCE.txt",
                {folder.string()});
  if (!unknown.empty())
    airtruth::warn(warn,
                   fmt::format("{}: {} results are for no sequence of the data set (the first: {})",
                               folder.string(),
                               unknown.size(),
                               *unknown.begin()));
  if (tracker.sequences.size() < truths.size())
    airtruth::warn(warn,
                   fmt::format("{}: has results for {} of {} sequences; its score is of those",
                               folder.string(),
                               tracker.sequences.size(),
                               truths.size()));
  std::vector<Score> scores;
  for (const ScoredSequence& sequence : tracker.sequences) scores.push_back(sequence.score);
  tracker.overall = evaluation::mean_of(scores);
  return tracker;
}

Json json_of(const Score& score) {
  Json json = {{"frames", score.frames}, {"frames_with_target", score.counted}};
  for (const Column& column : kColumns) json[column.name] = score.*column.value;
  json["success"] = score.success;
  json["precision"] = score.precision;
  json["normalised_precision"] = score.normalised;
  return json;
}

std::string csv_line(const std::string& head, const Score& score) {
  std::string line = head + fmt::format(",{},{}", score.frames, score.counted);
  for (const Column& column : kColumns) line += fmt::format(",{}", score.*column.value);
  return line + "\n";
}

std::string csv_head(const std::string& head) {
  std::string line = head + ",frames,frames_with_target";
  for (const Column& column : kColumns) line += std::string(",") + column.name;
  return line + "\n";
}

// RFC 4180.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? "\"\"" : std::string(1, c);
  return result + "\"";
}

}  // namespace

std::vector<ScoredTracker> evaluate(const fs::path& set,
                                    const std::vector<fs::path>& results,
                                    int origin_px,
                                    const Warn& warn) {
  const auto truths = truths_of(LabelledSet(set));
  std::vector<ScoredTracker> trackers;
  for (const fs::path& folder : results) {
    if (!fs::is_directory(folder)) throw Error("is no folder of results", {folder.string()});
    trackers.push_back(scored(folder, truths, origin_px, warn));
  }
  return trackers;
}

void write_evaluation(const std::vector<ScoredTracker>& trackers, const fs::path& out) {
  std::error_code failed;
  fs::create_directories(out, failed);
  if (failed) throw Error("cannot create: " + failed.message(), {out.string()});
  Json all = {
      {"format", "airtruth evaluation 1"}, {"version", kVersion}, {"trackers", Json::array()}};
  std::string overall = csv_head("tracker");
  std::string each = csv_head("tracker,sequence");
  for (const ScoredTracker& tracker : trackers) {
    Json sequences = Json::array();
    for (const ScoredSequence& sequence : tracker.sequences) {
      Json json = {{"name", sequence.name}};
      json.update(json_of(sequence.score));
      sequences.push_back(json);
      each += csv_line(quoted(tracker.name) + "," + quoted(sequence.name), sequence.score);
    }
    all["trackers"].push_back(
        {{"name", tracker.name}, {"overall", json_of(tracker.overall)}, {"sequences", sequences}});
    overall += csv_line(quoted(tracker.name), tracker.overall);
  }
  write_file(out / "trackers.csv", overall);
  write_file(out / "sequences.csv", each);
  write_file(out / "evaluation.json", all.dump(1) + "\n");
}

}  // namespace airtruth::dataset
