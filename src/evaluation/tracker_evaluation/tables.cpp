// SPDX-License-Identifier: Apache-2.0
#include "evaluation/tracker_evaluation/tables.h"

#include <cmath>

#include <airtruth/version.h>
#include <fmt/format.h>

#include "evaluation/report/tables.h"

namespace airtruth::tracker_evaluation {
namespace {

using evaluation::Score;
using measures::Bin;
using report::Json;
using report::or_null;
using report::quoted;

Json json_of(const Score& score) {
  Json json = {{"frames", score.frames}, {"frames_with_target", score.counted}};
  for (const Measure& measure : measures()) json[measure.name] = score.*measure.value;
  json["success"] = score.success;
  json["precision"] = score.precision;
  json["normalised_precision"] = score.normalised;
  return json;
}

Json json_of(const evaluation::Restart& r) {
  return {{"accuracy", r.accuracy},
          {"failures", r.failures},
          {"reliability", r.reliability},
          {"eao", or_null(r.eao)},
          {"eao_curve", r.eao_curve}};
}

Json json_of(const evaluation::MultiStart& m) {
  return {{"accuracy", m.accuracy},
          {"robustness", m.robustness},
          {"eao", or_null(m.eao)},
          {"eao_curve", m.eao_curve}};
}

Json json_of(const Bin& bin) {
  return {{"frames", bin.frames},
          {"overlap", bin.overlap},
          {"success_50", bin.success_50},
          {"precision_20px", bin.precision_20px},
          {"centre_px", bin.centre_px},
          {"normalised", bin.normalised},
          {"angle_mrad", or_null(bin.angle_mrad)}};
}

Json json_of(const FirstLoss& loss) {
  return {
      {"frame", loss.frame}, {"time_s", or_null(loss.time_s)}, {"range_m", or_null(loss.range_m)}};
}

Json breakdown_of(const ScoredTracker& tracker) {
  Json json = Json::object();
  for (const auto& [key, bins] : tracker.bins) {
    Json list = Json::array();
    for (const Bin& bin : bins) {
      Json one = {{"from", bin.from}, {"to", report::json_of_bound(bin.to)}};
      one.update(json_of(bin));
      list.push_back(one);
    }
    json[key] = list;
  }
  Json backgrounds = Json::object();
  for (const auto& [name, bin] : tracker.backgrounds) backgrounds[name] = json_of(bin);
  json["background"] = backgrounds;
  return json;
}

// Nothing where there is no number.
std::string cell(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? fmt::format(",{}", *value) : ",";
}

std::string score_head() {
  std::string line = ",frames,frames_with_target";
  for (const Measure& measure : measures()) line += std::string(",") + measure.name;
  return line + ",angle_mrad";
}

std::string score_cells(const std::optional<Score>& score, const std::optional<double>& angle) {
  if (!score) return std::string(measures().size() + 3, ',');
  std::string line = fmt::format(",{},{}", score->frames, score->counted);
  for (const Measure& measure : measures()) line += cell((*score).*measure.value);
  return line + cell(angle);
}

constexpr const char* kVotHead =
    ",restart_accuracy,restart_failures,restart_eao,multistart_accuracy,multistart_robustness,"
    "multistart_eao";

std::string vot_cells(const std::optional<evaluation::Restart>& restart,
                      const std::optional<evaluation::MultiStart>& multistart) {
  return (restart ? cell(restart->accuracy) + cell(restart->failures) + cell(restart->eao)
                  : ",,,") +
         (multistart
              ? cell(multistart->accuracy) + cell(multistart->robustness) + cell(multistart->eao)
              : ",,,");
}

std::string trackers_csv(const Assessment& assessment) {
  std::string text = "tracker" + score_head();
  for (const Measure& measure : measures())
    text += fmt::format(",{0}_low_95,{0}_high_95", measure.name);
  text += std::string(kVotHead) + ",sequences_lost\n";
  for (const ScoredTracker& tracker : assessment.trackers) {
    text += quoted(tracker.name) + score_cells(tracker.overall, tracker.angle_mrad);
    for (const Measure& measure : measures()) {
      const auto found = tracker.intervals.find(measure.name);
      const bool known = found != tracker.intervals.end() && found->second;
      text += known ? cell(found->second->low) + cell(found->second->high) : ",,";
    }
    text += vot_cells(tracker.restart, tracker.multistart);
    text += fmt::format(",{}\n", tracker.lost);
  }
  return text;
}

std::string sequences_csv(const Assessment& assessment) {
  std::string text = "tracker,sequence" + score_head() + kVotHead +
                     ",first_loss_frame,first_loss_s,first_loss_range_m\n";
  for (const ScoredTracker& tracker : assessment.trackers)
    for (const ScoredSequence& sequence : tracker.sequences) {
      text += quoted(tracker.name) + "," + quoted(sequence.name) +
              score_cells(sequence.score, measures::mean_of(sequence.outcomes).angle_mrad) +
              vot_cells(sequence.restart, sequence.multistart);
      text += sequence.loss ? fmt::format(",{}", sequence.loss->frame) +
                                  cell(sequence.loss->time_s) + cell(sequence.loss->range_m)
                            : ",,,";
      text += "\n";
    }
  return text;
}

std::string breakdown_csv(const Assessment& assessment) {
  std::string text =
      "tracker,by,from,to,frames,overlap,success_50,precision_20px,centre_px,normalised,"
      "angle_mrad\n";
  const auto line = [&](const ScoredTracker& tracker,
                        const std::string& by,
                        const std::string& bounds,
                        const Bin& bin) {
    text += quoted(tracker.name) + "," + by + bounds + fmt::format(",{}", bin.frames) +
            cell(bin.overlap) + cell(bin.success_50) + cell(bin.precision_20px) +
            cell(bin.centre_px) + cell(bin.normalised) + cell(bin.angle_mrad) + "\n";
  };
  for (const ScoredTracker& tracker : assessment.trackers) {
    for (const auto& [key, bins] : tracker.bins)
      for (const Bin& bin : bins) line(tracker, key, cell(bin.from) + cell(bin.to), bin);
    for (const auto& [name, bin] : tracker.backgrounds)
      line(tracker, "background", "," + quoted(name) + ",", bin);
  }
  return text;
}

}  // namespace

Json json_of(const ScoredSequence& sequence) {
  Json json = {{"name", sequence.name}};
  if (sequence.score) {
    json.update(json_of(*sequence.score));
    json["angle_mrad"] = or_null(measures::mean_of(sequence.outcomes).angle_mrad);
    json["first_loss"] = sequence.loss ? json_of(*sequence.loss) : Json();
  }
  if (sequence.restart) json["restart"] = json_of(*sequence.restart);
  if (sequence.multistart) json["multistart"] = json_of(*sequence.multistart);
  return json;
}

Json json_of(const ScoredTracker& tracker) {
  Json json = {{"name", tracker.name}};
  if (tracker.overall) {
    Json overall = json_of(*tracker.overall);
    overall["angle_mrad"] = or_null(tracker.angle_mrad);
    overall["sequences_lost"] = tracker.lost;
    Json intervals = Json::object();
    for (const Measure& measure : measures())
      intervals[measure.name] = report::json_of(tracker.intervals.at(measure.name));
    overall["intervals_95"] = intervals;
    json["overall"] = overall;
    json["breakdown"] = breakdown_of(tracker);
  }
  if (tracker.restart) json["restart"] = json_of(*tracker.restart);
  if (tracker.multistart) json["multistart"] = json_of(*tracker.multistart);
  return json;
}

Json json_of(const TrackerPair& c) {
  return {{"a", c.a},
          {"b", c.b},
          {"sequences", c.sequences},
          {"auc_difference", c.auc.difference},
          {"interval_95", report::json_of(c.auc.interval)},
          {"p_value", c.auc.p_value},
          {"wins", c.auc.wins},
          {"losses", c.auc.losses},
          {"ties", c.auc.ties}};
}

void write_tables(const Assessment& assessment, const fs::path& out) {
  Json all = {{"format", "airtruth evaluation 2"},
              {"version", kVersion},
              {"dataset", assessment.set},
              {"eao_range", {assessment.eao_range.first, assessment.eao_range.second}},
              {"speed_until_loss", assessment.until_loss},
              {"trackers", Json::array()},
              {"comparisons", Json::array()}};
  for (const ScoredTracker& tracker : assessment.trackers) {
    Json json = json_of(tracker);
    json["sequences"] = Json::array();
    for (const ScoredSequence& sequence : tracker.sequences)
      json["sequences"].push_back(json_of(sequence));
    all["trackers"].push_back(json);
  }
  for (const TrackerPair& comparison : assessment.comparisons)
    all["comparisons"].push_back(json_of(comparison));
  report::write_files(out,
                      {{"trackers.csv", trackers_csv(assessment)},
                       {"sequences.csv", sequences_csv(assessment)},
                       {"breakdown.csv", breakdown_csv(assessment)},
                       {"evaluation.json", all.dump(1) + "\n"}});
}

}  // namespace airtruth::tracker_evaluation
