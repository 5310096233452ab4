// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/scores/truth.h"
#include "foundation/base/names.h"
#include "runners/results/detections.h"

// The match of each detection with the truth of its frame: a detection is a true positive on the
// nearest aircraft whose centre is near enough (matching/boxes.h has the rule). Several detections
// may be on one aircraft; none of them is a false alarm.
namespace airtruth::scores {

// Match::what of a false alarm on nothing that the truth knows.
constexpr const char* kBackground = "background";

enum class MatchKind {
  kTruePositive,  // it is on an aircraft that counts
  kIgnored,       // it is on an aircraft that does not count, or in an ignored region
  kFalseAlarm,    // all others
};

constexpr auto enum_names(MatchKind) {
  return std::to_array<EnumName<MatchKind>>({{MatchKind::kTruePositive, "found"},
                                             {MatchKind::kIgnored, "ignored"},
                                             {MatchKind::kFalseAlarm, "false alarm"}});
}

struct Match {
  MatchKind kind = MatchKind::kFalseAlarm;
  // The object that the detection is on: the aircraft found, also one that does not count, or what
  // it mistakes for one. Empty where there is nothing, and in an ignored region.
  std::optional<std::int64_t> object;
  // Class of that object ("aircraft", "bird"), "ignore" in an ignored region, kBackground where
  // there is nothing, and the detection's own category where it does not claim an aircraft.
  std::string what;
};

// Aircraft that count come first, then those that do not, ignored regions (the centre lies in the
// region), and last other objects, by the same rule of distance as aircraft.
Match match_of(const Box& detection_px, const TruthFrame& truth, double centre_px);

// True for a detection that claims to be an aircraft: its words (annotation::class_of_category())
// say so, or the labels of the set (TruthSequence::class_of) do, or neither names another object. A
// detector that names birds as birds has no false alarm on them. Types of aircraft ("738") and
// unknown words are aircraft.
bool claims_aircraft(const std::string& category, const TruthSequence& truth);

// The matches of a sequence, in the order of its detections. A detection that claims something
// else than an aircraft is kIgnored. Frames that only one of the two has get none.
std::vector<std::vector<Match>> matches_of(const results::SequenceDetections& detections,
                                           const TruthSequence& truth,
                                           double centre_px);

// The detections of one sequence, and what became of each.
struct ScoredDetections {
  std::size_t truth = 0;  // index in Assessment::truths
  results::SequenceDetections detections;
  // matches[frame][i] belongs to detections.frames[frame][i].
  std::vector<std::vector<Match>> matches;

  // Calls use(frame, detection, match) for every detection that has a match.
  void each(const auto& use) const {
    for (std::size_t i = 0; i < matches.size(); ++i)
      for (std::size_t k = 0; k < matches[i].size(); ++k)
        use(i, detections.frames[i][k], matches[i][k]);
  }
};

// The detection of the highest score that finds each aircraft of a frame, by TruthObject::id.
std::map<std::int64_t, const results::Detection*> best_of(const ScoredDetections& scored,
                                                          std::size_t frame);

// Calls use(frame, index, best) for each aircraft of a sequence that counts. `index` is in
// TruthFrame::objects; `best` is the detection of best_of(), or null.
void each_aircraft(const TruthSequence& truth, const ScoredDetections& scored, const auto& use) {
  for (std::size_t i = 0; i < scored.matches.size(); ++i) {
    const auto best = best_of(scored, i);
    for (std::size_t k = 0; k < truth.frames[i].objects.size(); ++k) {
      const TruthObject& object = truth.frames[i].objects[k];
      if (!object.is_aircraft() || !object.counts) continue;
      const auto found = best.find(object.id);
      use(i, k, found == best.end() ? nullptr : found->second);
    }
  }
}

}  // namespace airtruth::scores
