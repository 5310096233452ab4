// SPDX-License-Identifier: Apache-2.0
#include <airtruth/froc.h>

#include "evaluation/scores/detection_match.h"
#include "evaluation/scores/detector_score.h"
#include "evaluation/scores/truth.h"
#include "runners/results/detections.h"

namespace airtruth::evaluation {

FrocSequence froc_sequence(std::span<const ScoredImage> images,
                           double duration_s,
                           double centre_px) {
  scores::TruthSequence truth;
  truth.duration_s = duration_s;
  scores::ScoredDetections scored;
  for (const ScoredImage& image : images) {
    scores::TruthFrame& frame = truth.frames.emplace_back();
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
    std::vector<results::Detection>& detections = scored.detections.frames.emplace_back();
    for (const ScoredBox& box : image.detections)
      detections.push_back({.box_px = box.box_px, .score = box.score});
  }
  scored.matches = scores::matches_of(scored.detections, truth, centre_px);
  return scores::froc_sequence_of(truth, scored);
}

}  // namespace airtruth::evaluation
