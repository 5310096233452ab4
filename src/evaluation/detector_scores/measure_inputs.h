// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "evaluation/detection_measures/aot.h"
#include "evaluation/detection_measures/average_precision.h"
#include "evaluation/detection_measures/bearing_error.h"
#include "evaluation/detection_measures/froc.h"
#include "evaluation/detection_measures/track_measures.h"
#include "evaluation/detector_scores/breakdown.h"
#include "evaluation/detector_scores/detector_score.h"
#include "evaluation/detector_scores/truth.h"

// A sequence's truth and detections in the form that each measure takes.
namespace airtruth::detector_scores {

// Aircraft that count are truths; those that do not, and ignored regions, are regions. Detections
// that claim something else than an aircraft are left out, here and below.
std::vector<detection_measures::ScoredImage> images_of(const TruthSequence& truth,
                                                       const ScoredDetections& scored);

detection_measures::FrocSequence froc_sequence_of(const TruthSequence& truth,
                                                  const ScoredDetections& scored);

// `sequence` is the number that the sightings and samples get.
std::vector<AircraftInFrame> sightings_of(std::size_t sequence,
                                          const TruthSequence& truth,
                                          const ScoredDetections& scored,
                                          double score);

// Of the detection of the highest score that finds the aircraft, in each frame. Empty without a
// lens.
std::vector<detection_measures::BearingSample> bearing_samples_of(std::size_t sequence,
                                                                  const TruthSequence& truth,
                                                                  const ScoredDetections& scored,
                                                                  double score);

// Aircraft, birds, multirotors and balloons are objects, the latter three without a range, as in
// the challenge's truth. Ignored detections are left out.
detection_measures::AotFlight aot_flight_of(const TruthSequence& truth,
                                            const ScoredDetections& scored);

// Aircraft that count, and detections with a track that are not ignored, of this score or more.
detection_measures::TrackFrames track_frames_of(const TruthSequence& truth,
                                                const ScoredDetections& scored,
                                                std::optional<double> score);

}  // namespace airtruth::detector_scores
