// SPDX-License-Identifier: Apache-2.0
#include "evaluation/scores/declaration.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include <airtruth/froc.h>

namespace airtruth::scores {
namespace {

// The frames that show an aircraft, and the tracks that are on it there.
struct Appearance {
  std::vector<std::size_t> frames;  // indices in TruthSequence::frames
  std::vector<const TruthObject*> objects;
  std::vector<std::set<std::int64_t>> tracks;
  bool counts = false;  // in any frame
};

std::map<std::int64_t, Appearance> appearances_of(const TruthSequence& truth) {
  std::map<std::int64_t, Appearance> appearances;
  for (std::size_t i = 0; i < truth.frames.size(); ++i)
    for (const TruthObject& object : truth.frames[i].objects) {
      if (!object.is_aircraft()) continue;
      Appearance& appearance = appearances[object.id];
      appearance.frames.push_back(i);
      appearance.objects.push_back(&object);
      appearance.tracks.emplace_back();
      appearance.counts = appearance.counts || object.counts;
    }
  return appearances;
}

void add_tracks(const ScoredDetections& scored,
                std::optional<double> score,
                std::map<std::int64_t, Appearance>& appearances) {
  for (std::size_t i = 0; i < scored.matches.size(); ++i)
    for (std::size_t k = 0; k < scored.matches[i].size(); ++k) {
      const results::Detection& detection = scored.detections.frames[i][k];
      const Match& match = scored.matches[i][k];
      if (!detection.track || !match.object || match.kind == MatchKind::kFalseAlarm) continue;
      if (score && detection.score < *score) continue;
      const auto found = appearances.find(*match.object);
      if (found == appearances.end()) continue;
      Appearance& appearance = found->second;
      const auto at = std::lower_bound(appearance.frames.begin(), appearance.frames.end(), i);
      if (at == appearance.frames.end() || *at != i) continue;
      appearance.tracks[static_cast<std::size_t>(at - appearance.frames.begin())].insert(
          *detection.track);
    }
}

// True where the track is on the aircraft in enough of the frames from `first` on.
bool is_kept(const TruthSequence& truth,
             const Appearance& appearance,
             std::size_t first,
             std::int64_t track) {
  // Time stamps carry rounding errors of their time base.
  constexpr double kRounding_s = 1e-6;
  const double end_s = truth.frames[appearance.frames[first]].time_s + kKeep_s - kRounding_s;
  double shown = 0;
  double on = 0;
  for (std::size_t i = first; i < appearance.frames.size(); ++i) {
    if (truth.frames[appearance.frames[i]].time_s >= end_s) break;
    shown += 1;
    on += appearance.tracks[i].contains(track) ? 1 : 0;
  }
  return on >= kKeepShare * shown;
}

std::optional<Declaration> declaration_of(const TruthSequence& truth,
                                          const Appearance& appearance) {
  for (std::size_t i = 0; i < appearance.frames.size(); ++i)
    for (const std::int64_t track : appearance.tracks[i]) {
      if (!is_kept(truth, appearance, i, track)) continue;
      const std::size_t frame = appearance.frames[i];
      return Declaration{frame,
                         truth.frames[frame].time_s,
                         track,
                         appearance.objects[i]->range_m,
                         appearance.objects[i]->to_closest_approach_s};
    }
  return std::nullopt;
}

InTime in_time(const TruthSequence& truth,
               const EncounterScore& score,
               std::optional<double> manoeuvre_s) {
  const TruthEncounter* encounter = truth.encounter(score.object);
  if (!manoeuvre_s || encounter == nullptr || !encounter->has_volume) return InTime::kUnknown;
  if (!encounter->violation_s) return InTime::kNoViolation;
  const double latest_s = *encounter->violation_s - *manoeuvre_s;
  if (latest_s < truth.frames.front().time_s) return InTime::kImpossible;
  return score.declaration && score.declaration->time_s <= latest_s ? InTime::kYes : InTime::kNo;
}

EncounterScore score_of(const TruthSequence& truth, const Appearance& appearance) {
  EncounterScore score;
  bool is_first = true;
  for (std::size_t i = 0; i < appearance.frames.size(); ++i) {
    const TruthObject& object = *appearance.objects[i];
    if (!object.counts) continue;
    if (std::exchange(is_first, false)) {
      score.first_seen = appearance.frames[i];
      score.first_seen_range_m = object.range_m;
    }
    ++score.frames_seen;
    if (object.range_m)
      score.least_range_m =
          std::min(score.least_range_m.value_or(*object.range_m), *object.range_m);
  }
  score.declaration = declaration_of(truth, appearance);
  return score;
}

std::optional<WeightedMean> mean_of(const std::vector<double>& values,
                                    const std::vector<double>& weights) {
  double sum = 0;
  double weight = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += weights[i] * values[i];
    weight += weights[i];
  }
  if (!(weight > 0)) return std::nullopt;
  return WeightedMean{
      sum / weight, evaluation::bootstrap_mean(values, weights), std::ssize(values)};
}

// Values with the weights of their sequences.
struct Weighted {
  std::vector<double> values;
  std::vector<double> weights;
  void add(const std::optional<double>& value, double weight) {
    if (!value) return;
    values.push_back(*value);
    weights.push_back(weight);
  }
  std::optional<WeightedMean> mean() const { return mean_of(values, weights); }
};

}  // namespace

std::vector<EncounterScore> encounters_of(std::size_t sequence,
                                          const TruthSequence& truth,
                                          const ScoredDetections& scored,
                                          std::optional<double> score,
                                          std::optional<double> manoeuvre_s) {
  std::map<std::int64_t, Appearance> appearances = appearances_of(truth);
  add_tracks(scored, score, appearances);
  std::vector<EncounterScore> scores;
  for (const auto& [object, appearance] : appearances) {
    if (!appearance.counts) continue;
    EncounterScore& one = scores.emplace_back(score_of(truth, appearance));
    one.sequence = sequence;
    one.object = object;
    one.in_time = in_time(truth, one, manoeuvre_s);
  }
  return scores;
}

DeclarationSummary summarised(std::span<const EncounterScore> encounters,
                              std::span<const double> weights) {
  statistics::TrialsBySequence declared;
  statistics::TrialsBySequence in_time;
  Weighted ranges;
  Weighted times;
  DeclarationSummary summary;
  for (const EncounterScore& one : encounters) {
    const double weight = weights.empty() ? 1 : weights[one.sequence];
    declared.add(one.sequence, one.declaration.has_value());
    if (one.declaration) {
      ranges.add(one.declaration->range_m, weight);
      times.add(one.declaration->to_closest_approach_s, weight);
    }
    summary.no_violation += one.in_time == InTime::kNoViolation ? 1 : 0;
    summary.impossible += one.in_time == InTime::kImpossible ? 1 : 0;
    summary.unknown += one.in_time == InTime::kUnknown ? 1 : 0;
    if (one.in_time == InTime::kYes || one.in_time == InTime::kNo)
      in_time.add(one.sequence, one.in_time == InTime::kYes);
  }
  summary.declared = declared.proportion(weights);
  summary.range_m = ranges.mean();
  summary.to_closest_approach_s = times.mean();
  if (!in_time.empty()) summary.in_time = in_time.proportion(weights);
  return summary;
}

std::int64_t false_tracks(const ScoredDetections& scored, std::optional<double> score) {
  struct Count {
    std::int64_t all = 0;
    std::int64_t false_alarms = 0;
  };
  std::map<std::int64_t, Count> tracks;
  for (std::size_t i = 0; i < scored.matches.size(); ++i)
    for (std::size_t k = 0; k < scored.matches[i].size(); ++k) {
      const results::Detection& detection = scored.detections.frames[i][k];
      if (!detection.track || (score && detection.score < *score)) continue;
      if (scored.matches[i][k].kind == MatchKind::kIgnored) continue;
      Count& count = tracks[*detection.track];
      ++count.all;
      count.false_alarms += scored.matches[i][k].kind == MatchKind::kFalseAlarm ? 1 : 0;
    }
  return std::count_if(tracks.begin(), tracks.end(), [](const auto& track) {
    return 2 * track.second.false_alarms > track.second.all;
  });
}

namespace {

// Scores at ranks that grow by a constant factor from the first to the last: the part of the curve
// with few false tracks has most of the points.
std::vector<double> thresholds_of(std::vector<double> scores, std::size_t most) {
  std::sort(scores.begin(), scores.end(), std::greater<>());
  scores.erase(std::unique(scores.begin(), scores.end()), scores.end());
  if (scores.size() <= most) return scores;
  std::vector<double> thresholds;
  const double last = static_cast<double>(scores.size() - 1);
  for (std::size_t i = 0; i < most; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(most - 1);
    const double score =
        scores[static_cast<std::size_t>(std::lround(std::pow(last + 1, share)) - 1)];
    if (thresholds.empty() || score < thresholds.back()) thresholds.push_back(score);
  }
  return thresholds;
}

}  // namespace

std::vector<OperatingPoint> operating_curve(std::span<const ScoredDetections> sequences,
                                            std::span<const TruthSequence> truths,
                                            std::size_t most) {
  std::vector<double> scores;
  double hours = 0;
  for (const ScoredDetections& sequence : sequences) {
    hours += truths[sequence.truth].duration_s / evaluation::kSecondsPerHour;
    for (const std::vector<results::Detection>& frame : sequence.detections.frames)
      for (const results::Detection& detection : frame)
        if (detection.track) scores.push_back(detection.score);
  }
  std::vector<OperatingPoint> curve;
  for (const double threshold : thresholds_of(std::move(scores), most)) {
    std::vector<EncounterScore> encounters;
    std::int64_t alarms = 0;
    Weighted all;
    for (std::size_t i = 0; i < sequences.size(); ++i) {
      for (const EncounterScore& one :
           encounters_of(i, truths[sequences[i].truth], sequences[i], threshold, {})) {
        encounters.push_back(one);
        if (one.first_seen_range_m)
          all.add(one.declaration ? one.declaration->range_m : std::optional(0.0), 1);
      }
      alarms += false_tracks(sequences[i], threshold);
    }
    const DeclarationSummary summary = summarised(encounters, {});
    curve.push_back({threshold,
                     hours > 0 ? static_cast<double>(alarms) / hours : 0,
                     summary.declared,
                     summary.range_m,
                     all.mean()});
  }
  return curve;
}

}  // namespace airtruth::scores
