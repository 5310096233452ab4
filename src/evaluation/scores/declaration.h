// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <airtruth/statistics.h>

#include "evaluation/scores/detection_match.h"
#include "evaluation/scores/truth.h"
#include "evaluation/statistics/proportion.h"
#include "foundation/base/names.h"
#include "runners/results/detections.h"

// When a detector's tracks declare an aircraft, and whether that leaves time for a manoeuvre.
//
// A track declares an aircraft in the first frame in which it is on it (scores/detection_match.h)
// and from which on it is kept: in the kKeep_s seconds that follow, or as many as show the
// aircraft, the same track is on it in at least half of the frames that show it (AOT's rule: half
// of 30 frames at 10 Hz).
//
// Example: an aircraft is in view from 0 s on, and its closest approach is at 40 s. Track 3 is on
// it at 6 s for one frame, and from 9 s on in all frames; the range at 9 s is 2100 m. It is
// declared at 9 s, at 2100 m and 31 s before the closest approach. It violates the volume at 33 s:
// for a manoeuvre of 20 s it is declared in time, since 9 <= 33 - 20.
namespace airtruth::scores {

constexpr double kKeep_s = 3;  // 30 frames at 10 Hz, AOT's rule
// The share of the frames that show the aircraft: AOT's rule.
constexpr double kKeepShare = 0.5;

struct Declaration {
  std::size_t frame = 0;  // index in TruthSequence::frames
  double time_s = 0;
  std::int64_t track = 0;
  std::optional<double> range_m;
  std::optional<double> to_closest_approach_s;
};

enum class InTime {
  kUnknown,      // no volume was asked for, or nothing is known of it
  kNoViolation,  // the aircraft never violates the volume
  kImpossible,   // the clip begins later than the manoeuvre would have to, or violated
  kYes,
  kNo,
};

constexpr auto enum_names(InTime) {
  return std::to_array<EnumName<InTime>>({{InTime::kUnknown, "unknown"},
                                          {InTime::kNoViolation, "no violation"},
                                          {InTime::kImpossible, "impossible"},
                                          {InTime::kYes, "yes"},
                                          {InTime::kNo, "no"}});
}

// One aircraft of one sequence.
struct EncounterScore {
  // Index in DetectorScore::sequences.
  std::size_t sequence = 0;
  std::int64_t object = 0;  // TruthObject::id
  // Of the frames that show the aircraft and count.
  std::size_t first_seen = 0;  // index in TruthSequence::frames
  std::int64_t frames_seen = 0;
  std::optional<double> first_seen_range_m;
  std::optional<double> least_range_m;
  std::optional<Declaration> declaration;
  InTime in_time = InTime::kUnknown;
};

// Detections below `score` do not count; empty: all do. Nothing where the times of the frames are
// unknown: no track is known to be kept for kKeep_s.
std::vector<EncounterScore> encounters_of(std::size_t sequence,
                                          const TruthSequence& truth,
                                          const ScoredDetections& scored,
                                          std::optional<double> score,
                                          std::optional<double> manoeuvre_s);

// Mean and 95 % interval (percentile bootstrap over sequences), weighted where the set is.
struct WeightedMean {
  double mean = 0;
  std::optional<evaluation::Interval> interval;
  std::int64_t count = 0;
};

struct DeclarationSummary {
  statistics::Proportion declared;
  // Of those that are declared and have the value.
  std::optional<WeightedMean> range_m;
  std::optional<WeightedMean> to_closest_approach_s;
  // Of the encounters that violate the volume and leave the time for the manoeuvre.
  std::optional<statistics::Proportion> in_time;
  std::int64_t no_violation = 0;
  std::int64_t impossible = 0;
  std::int64_t unknown = 0;
};
// `weights`: of the sequences; empty: all are 1.
DeclarationSummary summarised(std::span<const EncounterScore> encounters,
                              std::span<const double> weights);

// Tracks that are false alarms: most of the track's detections that are not ignored are.
std::int64_t false_tracks(const ScoredDetections& scored, std::optional<double> score);

// The system operating curve (Lai et al. 2011, DICTA): declaration range against false tracks an
// hour, as the threshold on the score of detections falls.
struct OperatingPoint {
  double score = 0;
  double false_tracks_per_hour = 0;
  statistics::Proportion declared;
  // Over the declared encounters with a range.
  std::optional<WeightedMean> range_m;
  // Over all encounters of aircraft with ranges; 0 m where not declared.
  std::optional<WeightedMean> range_all_m;
};
// By falling score, at most `most` points, over the scores of detections with a track.
std::vector<OperatingPoint> operating_curve(std::span<const ScoredDetections> sequences,
                                            std::span<const TruthSequence> truths,
                                            std::size_t most = 40);

}  // namespace airtruth::scores
