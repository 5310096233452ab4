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

// A frame that shows an aircraft, and the tracks that are on it there.
struct Shown {
  std::size_t frame = 0;  // index in TruthSequence::frames
  const TruthObject* object = nullptr;
  std::set<std::int64_t> tracks;
};

// By TruthObject::id.
std::map<std::int64_t, std::vector<Shown>> appearances_of(const TruthSequence& truth,
                                                          const ScoredDetections& scored,
                                                          std::optional<double> score) {
  std::map<std::int64_t, std::vector<Shown>> appearances;
  for (std::size_t i = 0; i < truth.frames.size(); ++i)
    for (const TruthObject& object : truth.frames[i].objects)
      if (object.is_aircraft()) appearances[object.id].push_back({i, &object, {}});
  scored.each([&](std::size_t i, const results::Detection& detection, const Match& match) {
    if (!detection.track || !match.object || match.kind == MatchKind::kFalseAlarm ||
        (score && detection.score < *score))
      return;
    std::vector<Shown>& shown = appearances.at(*match.object);
    std::ranges::lower_bound(shown, i, {}, &Shown::frame)->tracks.insert(*detection.track);
  });
  return appearances;
}

// True where the track is on the aircraft in enough of the frames from `first` on.
bool is_kept(const TruthSequence& truth,
             const std::vector<Shown>& shown,
             std::size_t first,
             std::int64_t track) {
  // Time stamps carry rounding errors of their time base.
  constexpr double kRounding_s = 1e-6;
  const double end_s = truth.frames[shown[first].frame].time_s + kKeep_s - kRounding_s;
  double frames = 0;
  double on = 0;
  for (std::size_t i = first; i < shown.size(); ++i) {
    if (truth.frames[shown[i].frame].time_s >= end_s) break;
    frames += 1;
    on += shown[i].tracks.contains(track) ? 1 : 0;
  }
  return on >= kKeepShare * frames;
}

std::optional<Declaration> declaration_of(const TruthSequence& truth,
                                          const std::vector<Shown>& shown) {
  for (std::size_t i = 0; i < shown.size(); ++i)
    for (const std::int64_t track : shown[i].tracks)
      if (is_kept(truth, shown, i, track))
        return Declaration{shown[i].frame,
                           truth.frames[shown[i].frame].time_s,
                           track,
                           shown[i].object->range_m,
                           shown[i].object->to_closest_approach_s};
  return std::nullopt;
}

InTime in_time(const TruthSequence& truth,
               const EncounterScore& score,
               std::optional<double> manoeuvre_s) {
  const TruthEncounter* encounter = truth.encounter(score.object);
  if (!manoeuvre_s || encounter == nullptr || !encounter->has_volume) return InTime::kUnknown;
  if (!encounter->violation_s) return InTime::kNoViolation;
  const double begin_s = truth.frames.front().time_s;
  const double latest_s = *encounter->violation_s - *manoeuvre_s;
  if (*encounter->violation_s <= begin_s || latest_s < begin_s) return InTime::kImpossible;
  return score.declaration && score.declaration->time_s <= latest_s ? InTime::kYes : InTime::kNo;
}

EncounterScore score_of(const TruthSequence& truth, const std::vector<Shown>& shown) {
  EncounterScore score;
  for (const Shown& one : shown) {
    if (!one.object->counts) continue;
    const std::optional<double>& range_m = one.object->range_m;
    if (score.frames_seen++ == 0) {
      score.first_seen = one.frame;
      score.first_seen_range_m = range_m;
    }
    if (range_m) score.least_range_m = std::min(score.least_range_m.value_or(*range_m), *range_m);
  }
  score.declaration = declaration_of(truth, shown);
  return score;
}

// Values of encounters with the weights of their sequences, which are what is drawn.
class Weighted {
 public:
  void add(std::size_t sequence, const std::optional<double>& value, double weight) {
    if (!value) return;
    Sums& sums = sequences_[sequence];
    sums.values += *value;
    sums.weight += weight;
    ++sums.count;
    weighted_ += *value * weight;
    weight_ += weight;
    ++count_;
  }
  std::optional<WeightedMean> mean() const {
    if (!(weight_ > 0)) return std::nullopt;
    std::vector<double> means, weights;
    for (const auto& [sequence, sums] : sequences_) {
      means.push_back(sums.values / static_cast<double>(sums.count));
      weights.push_back(sums.weight);
    }
    return WeightedMean{weighted_ / weight_, evaluation::bootstrap_mean(means, weights), count_};
  }

 private:
  struct Sums {
    double values = 0, weight = 0;
    std::int64_t count = 0;
  };
  std::map<std::size_t, Sums> sequences_;
  double weighted_ = 0, weight_ = 0;
  std::int64_t count_ = 0;
};

}  // namespace

std::vector<EncounterScore> encounters_of(std::size_t sequence,
                                          const TruthSequence& truth,
                                          const ScoredDetections& scored,
                                          std::optional<double> score,
                                          std::optional<double> manoeuvre_s) {
  std::vector<EncounterScore> scores;
  if (!truth.has_times) return scores;
  for (const auto& [object, shown] : appearances_of(truth, scored, score)) {
    EncounterScore one = score_of(truth, shown);
    if (one.frames_seen == 0) continue;
    one.sequence = sequence;
    one.object = object;
    one.in_time = in_time(truth, one, manoeuvre_s);
    scores.push_back(one);
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
      ranges.add(one.sequence, one.declaration->range_m, weight);
      times.add(one.sequence, one.declaration->to_closest_approach_s, weight);
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
  // Of each track: how many more of its detections are false alarms than are not.
  std::map<std::int64_t, std::int64_t> excess;
  scored.each([&](std::size_t, const results::Detection& detection, const Match& match) {
    if (detection.track && match.kind != MatchKind::kIgnored &&
        (!score || detection.score >= *score))
      excess[*detection.track] += match.kind == MatchKind::kFalseAlarm ? 1 : -1;
  });
  return std::ranges::count_if(excess, [](const auto& track) { return track.second > 0; });
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
          all.add(i, one.declaration ? one.declaration->range_m : std::optional(0.0), 1);
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
