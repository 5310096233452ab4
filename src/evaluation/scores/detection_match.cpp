// SPDX-License-Identifier: Apache-2.0
#include "evaluation/scores/detection_match.h"

#include <algorithm>

#include "evaluation/matching/boxes.h"
#include "labels/annotation/object_class.h"

namespace airtruth::scores {
namespace {

// The nearest object within its radius, of those that `which` selects.
template <typename Which>
const TruthObject* nearest(const Box& detection_px,
                           const TruthFrame& truth,
                           double centre_px,
                           Which which) {
  const TruthObject* best = nullptr;
  double least = 0;
  for (const TruthObject& object : truth.objects) {
    if (!which(object)) continue;
    const double distance = matching::centre_distance_px(detection_px, object.box_px);
    if (distance > matching::match_radius_px(object.box_px, centre_px)) continue;
    if (best != nullptr && distance >= least) continue;
    best = &object;
    least = distance;
  }
  return best;
}

}  // namespace

Match match_of(const Box& detection_px, const TruthFrame& truth, double centre_px) {
  const auto found = [&](auto which) { return nearest(detection_px, truth, centre_px, which); };
  if (const auto* object = found([](const auto& o) { return o.is_aircraft() && o.counts; }))
    return {MatchKind::kTruePositive, object->id, object->object_class};
  if (const auto* object = found([](const auto& o) { return o.is_aircraft() && !o.counts; }))
    return {MatchKind::kIgnored, object->id, object->object_class};
  for (const Box& region : truth.ignored_px)
    if (matching::centre_is_in(detection_px, region)) return {MatchKind::kIgnored, {}, "ignore"};
  if (const auto* object = found([](const auto& o) { return !o.is_aircraft(); }))
    return {MatchKind::kFalseAlarm, object->id, object->object_class};
  return {MatchKind::kFalseAlarm, {}, kBackground};
}

bool claims_aircraft(const std::string& category, const TruthSequence& truth) {
  const auto by_words = annotation::class_of_category(category);
  if (by_words == annotation::kAircraft) return true;
  const auto labelled = truth.class_of.find(category);
  return labelled != truth.class_of.end() ? annotation::is_aircraft(labelled->second) : !by_words;
}

std::vector<std::vector<Match>> matches_of(const results::SequenceDetections& detections,
                                           const TruthSequence& truth,
                                           double centre_px) {
  std::vector<std::vector<Match>> matches;
  const std::size_t frames = std::min(detections.frames.size(), truth.frames.size());
  for (std::size_t i = 0; i < frames; ++i) {
    std::vector<Match>& of_frame = matches.emplace_back();
    for (const results::Detection& detection : detections.frames[i])
      of_frame.push_back(claims_aircraft(detection.category, truth)
                             ? match_of(detection.box_px, truth.frames[i], centre_px)
                             : Match{MatchKind::kIgnored, {}, detection.category});
  }
  return matches;
}

std::map<std::int64_t, const results::Detection*> best_of(const ScoredDetections& scored,
                                                          std::size_t frame) {
  std::map<std::int64_t, const results::Detection*> best;
  for (std::size_t k = 0; k < scored.matches[frame].size(); ++k) {
    const Match& match = scored.matches[frame][k];
    if (match.kind != MatchKind::kTruePositive) continue;
    const results::Detection*& found = best[*match.object];
    const results::Detection& detection = scored.detections.frames[frame][k];
    if (found == nullptr || detection.score > found->score) found = &detection;
  }
  return best;
}

}  // namespace airtruth::scores
