// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "evaluation/measures/aot.h"
#include "evaluation/measures/average_precision.h"
#include "evaluation/measures/bearing_error.h"
#include "evaluation/measures/froc.h"
#include "evaluation/measures/track_measures.h"
#include "evaluation/scores/breakdown.h"
#include "evaluation/scores/detector_score.h"
#include "evaluation/scores/truth.h"

// A sequence's truth and detections in the form that each measure takes.
namespace airtruth::scores {

// Aircraft that count are truths; those that do not, and ignored regions, are regions. Detections
// that claim something else than an aircraft are left out, here and below.
std::vector<measures::ScoredImage> images_of(const TruthSequence& truth,
                                             const ScoredDetections& scored);

measures::FrocSequence froc_sequence_of(const TruthSequence& truth, const ScoredDetections& scored);

// `sequence` is the number that the sightings and samples get.
std::vector<AircraftInFrame> sightings_of(std::size_t sequence,
                                          const TruthSequence& truth,
                                          const ScoredDetections& scored,
                                          double score);

// Of the detection of the highest score that finds the aircraft, in each frame. Empty without a
// lens.
std::vector<measures::BearingSample> bearing_samples_of(std::size_t sequence,
                                                        const TruthSequence& truth,
                                                        const ScoredDetections& scored,
                                                        double score);

// Aircraft, birds, multirotors and balloons are objects, the latter three without a range, as in
// the challenge's truth. Ignored detections are left out.
measures::AotFlight aot_flight_of(const TruthSequence& truth, const ScoredDetections& scored);

// Aircraft that count, and detections with a track that are not ignored, of this score or more.
measures::TrackFrames track_frames_of(const TruthSequence& truth,
                                      const ScoredDetections& scored,
                                      std::optional<double> score);

}  // namespace airtruth::scores
