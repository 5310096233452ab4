// SPDX-License-Identifier: Apache-2.0
#include "evaluation/tracker_evaluation/tables.h"

#include <airtruth/version.h>
#include <fmt/format.h>

#include "evaluation/measures/score_measures.h"
#include "evaluation/report/tables.h"

namespace airtruth::tracker_evaluation {
namespace {

using evaluation::Score;
using measures::Bin;
using report::Json;
using report::list_of;

// The format of numbers in CSV: all their digits.
constexpr const char* kNumber = "{}";

// All values are null without a score.
Json json_of(const std::optional<Score>& score) {
  const auto of = [&](const auto& value) { return score ? Json(value(*score)) : Json(); };
  Json json = {{"frames", of([](const Score& s) { return s.frames; })},
               {"frames_with_target", of([](const Score& s) { return s.counted; })}};
  for (const measures::ScoreMeasure& measure : measures::kScoreMeasures)
    json[measure.name] = of([&](const Score& s) { return or_null(s.*measure.value); });
  json["success"] = of([](const Score& s) { return s.success; });
  json["precision"] = of([](const Score& s) { return s.precision; });
  json["normalised_precision"] = of([](const Score& s) { return s.normalised; });
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
          {"centre_px", or_null(bin.centre_px)},
          {"normalised", or_null(bin.normalised)},
          {"angle_mrad", or_null(bin.angle_mrad)}};
}

Json json_of(const FirstLoss& loss) {
  return {
      {"frame", loss.frame}, {"time_s", or_null(loss.time_s)}, {"range_m", or_null(loss.range_m)}};
}

Json breakdown_of(const ScoredTracker& tracker) {
  Json json = Json::object();
  for (const auto& [key, bins] : tracker.bins) {
    if (key == kBackground) continue;
    json[key] = list_of(bins, [](const Bin& bin) {
      // The last one's end is infinity, which is written as null.
      Json one = {{"from", bin.place.from}, {"to", bin.place.to}};
      one.update(json_of(bin));
      return one;
    });
  }
  Json backgrounds = Json::object();
  // A tracker that has VOT's runs alone has no bins.
  if (const auto found = tracker.bins.find(kBackground); found != tracker.bins.end())
    for (const Bin& bin : found->second) backgrounds[bin.place.name] = json_of(bin);
  json[kBackground] = backgrounds;
  return json;
}

Json overall_of(const ScoredTracker& tracker) {
  Json overall = json_of(tracker.overall);
  overall["angle_mrad"] = or_null(tracker.angle_mrad);
  overall["sequences_lost"] = tracker.lost;
  for (const measures::ScoreMeasure& measure : measures::kScoreMeasures)
    overall["intervals_95"][measure.name] = report::json_of(tracker.intervals.at(measure.name));
  return overall;
}

// The columns of a score that lies at a place.
std::string score_columns(const std::string& place) {
  std::string columns =
      ",frames=" + place + "frames,frames_with_target=" + place + "frames_with_target";
  for (const measures::ScoreMeasure& measure : measures::kScoreMeasures)
    columns += fmt::format(",{0}={1}{0}", measure.name, place);
  return columns + ",angle_mrad=" + place + "angle_mrad";
}

constexpr const char* kVotColumns =
    ",restart_accuracy=restart/accuracy,restart_failures=restart/failures,restart_eao=restart/eao,"
    "multistart_accuracy=multistart/accuracy,multistart_robustness=multistart/robustness,"
    "multistart_eao=multistart/eao";

std::string trackers_csv(const Assessment& assessment) {
  std::string columns = "tracker=name" + score_columns("overall/");
  for (const measures::ScoreMeasure& measure : measures::kScoreMeasures)
    columns += fmt::format(",{0}_*_95=overall/intervals_95/{0}", measure.name);
  std::vector<Json> rows;
  for (const ScoredTracker& tracker : assessment.trackers)
    rows.emplace_back(json_of(tracker))["sequences_lost"] = tracker.lost;
  return report::csv_of(columns + kVotColumns + ",sequences_lost", rows, kNumber);
}

std::string sequences_csv(const Assessment& assessment) {
  std::vector<Json> rows;
  for (const ScoredTracker& tracker : assessment.trackers)
    for (const ScoredSequence& sequence : tracker.sequences)
      rows.emplace_back(json_of(sequence))["tracker"] = tracker.name;
  return report::csv_of("tracker,sequence=name" + score_columns("") + kVotColumns +
                            ",first_loss_frame=first_loss/frame,first_loss_s=first_loss/time_s,"
                            "first_loss_range_m=first_loss/range_m",
                        rows,
                        kNumber);
}

std::string breakdown_csv(const Assessment& assessment) {
  std::vector<Json> rows;
  for (const ScoredTracker& tracker : assessment.trackers) {
    const Json breakdown = breakdown_of(tracker);
    for (const auto& [key, bins] : breakdown.items())
      for (const auto& [name, bin] : bins.items()) {
        Json& row = rows.emplace_back(bin);
        row["tracker"] = tracker.name;
        row["by"] = key;
        if (bins.is_object()) row["from"] = name;
      }
  }
  return report::csv_of(
      "tracker,by,from,to,frames,overlap,success_50,precision_20px,centre_px,normalised,angle_mrad",
      rows,
      kNumber);
}

}  // namespace

Json json_of(const ScoredSequence& sequence) {
  Json json = {{"name", sequence.name}};
  json.update(json_of(sequence.score));
  json["angle_mrad"] = or_null(measures::mean_of(sequence.outcomes).angle_mrad);
  json["first_loss"] = sequence.loss ? json_of(*sequence.loss) : Json();
  json["restart"] = sequence.restart ? json_of(*sequence.restart) : Json();
  json["multistart"] = sequence.multistart ? json_of(*sequence.multistart) : Json();
  return json;
}

Json json_of(const ScoredTracker& tracker) {
  return {{"name", tracker.name},
          {"overall", tracker.overall ? overall_of(tracker) : Json()},
          {"breakdown", tracker.overall ? breakdown_of(tracker) : Json()},
          {"restart", tracker.restart ? json_of(*tracker.restart) : Json()},
          {"multistart", tracker.multistart ? json_of(*tracker.multistart) : Json()}};
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
              {"where", assessment.where},
              {"trackers", Json::array()},
              {"comparisons",
               list_of(assessment.comparisons, [](const auto& one) { return json_of(one); })}};
  for (const ScoredTracker& tracker : assessment.trackers) {
    Json json = json_of(tracker);
    json["sequences"] = list_of(tracker.sequences, [](const auto& one) { return json_of(one); });
    all["trackers"].push_back(json);
  }
  report::write_files(out,
                      {{"trackers.csv", trackers_csv(assessment)},
                       {"sequences.csv", sequences_csv(assessment)},
                       {"breakdown.csv", breakdown_csv(assessment)},
                       {"evaluation.json", all.dump(1) + "\n"}});
}

}  // namespace airtruth::tracker_evaluation
