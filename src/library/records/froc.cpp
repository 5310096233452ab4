// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <airtruth/froc.h>

#include "evaluation/scores/detection_match.h"
#include "evaluation/scores/detector_score.h"
#include "evaluation/scores/truth.h"
#include "runners/results/detections.h"

namespace airtruth::evaluation {
namespace {

struct Matched {
  scores::TruthSequence truth;
  scores::ScoredDetections scored;
};

Matched matched(std::span<const ScoredImage> images, double centre_px) {
  Matched result;
  for (const ScoredImage& image : images) {
    scores::TruthFrame& frame = result.truth.frames.emplace_back();
    for (const LabelledBox& box : image.truths) {
      if (box.is_region) {
        frame.ignored_px.push_back(box.box_px);
        continue;
      }
      scores::TruthObject& object = frame.objects.emplace_back();
      object.id = std::ssize(frame.objects);
      object.box_px = box.box_px;
      object.counts = !box.is_ignored;
    }
    auto& detections = result.scored.detections.frames.emplace_back();
    for (const ScoredBox& box : image.detections)
      detections.push_back({.box_px = box.box_px, .score = box.score});
  }
  result.scored.matches = scores::matches_of(result.scored.detections, result.truth, centre_px);
  return result;
}

}  // namespace

FrocSequence froc_sequence(std::span<const ScoredImage> images,
                           double duration_s,
                           double centre_px) {
  Matched all = matched(images, centre_px);
  all.truth.duration_s = duration_s;
  return scores::froc_sequence_of(all.truth, all.scored);
}

std::vector<bool> counts_neither_way(const ScoredImage& image, double centre_px) {
  std::vector<bool> result;
  const Matched one = matched({&image, 1}, centre_px);
  for (const scores::Match& match : one.scored.matches[0])
    result.push_back(match.kind == scores::MatchKind::kIgnored);
  return result;
}

bool claims_aircraft(std::string_view category) {
  return scores::claims_aircraft(std::string(category), {});
}

}  // namespace airtruth::evaluation
