// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "evaluation/scores/detection_match.h"
#include "evaluation/scores/truth.h"
#include "runners/results/detections.h"

// The false alarms and misses that are worth a look. What goes on over frames is listed once.
namespace airtruth::scores {

// Detections that are false alarms in frames after each other, at most kGalleryGap frames apart and
// within their own size or 20 px of each other.
struct FalseAlarm {
  // Index in DetectorScore::sequences.
  std::size_t sequence = 0;
  // The strongest: indices in TruthSequence::frames and in that frame's detections.
  std::size_t frame = 0;
  std::size_t detection = 0;
  double score = 0;
  // "background", or the class of the object that it is on: "bird".
  std::string what;
  std::optional<std::int64_t> object;  // TruthObject::id of that object
  // To the centre of the nearest aircraft in that frame, px; empty where there is none.
  std::optional<double> to_aircraft_px;
  std::int64_t frames = 0;  // with a detection of this group
  // That have this one: sequences over one background repeat its false alarms.
  std::int64_t sequences = 1;
  // Of the strongest detection.
  Box box_px;
};

// Frames after each other in which one aircraft is not found.
struct Miss {
  // Index in DetectorScore::sequences.
  std::size_t sequence = 0;
  std::int64_t object = 0;  // TruthObject::id
  std::size_t first_frame = 0;
  std::int64_t frames = 0;  // that show it
  // The frame where it should have been easiest: the largest contrast to noise where that is known,
  // else the largest box. Index in TruthSequence::frames.
  std::size_t frame = 0;
  // Of the aircraft there.
  Box box_px;
  std::optional<double> range_m;
  // What it was chosen by.
  std::optional<double> contrast_to_noise;
  double size_px = 0;
};

constexpr std::size_t kGallerySize = 100;  // more than people look through
constexpr std::size_t kGalleryGap = 5;     // frames
constexpr double kGalleryReach_px = 20;    // what drifts by less from frame to frame goes on

// Of one sequence, detections with `score` or more; the strongest first.
std::vector<FalseAlarm> false_alarms_of(std::size_t sequence,
                                        const TruthSequence& truth,
                                        const ScoredDetections& scored,
                                        double score);

// Of one sequence, in which no detection with `score` or more finds the aircraft; that which should
// have been easiest first.
std::vector<Miss> misses_of(std::size_t sequence,
                            const TruthSequence& truth,
                            const ScoredDetections& scored,
                            double score);

// Of all sequences, in the same orders, at most kGallerySize. `backgrounds`: of each sequence, its
// background video and first frame, or empty where it has no other. At one place of one background,
// the strongest alarm stands for those of all sequences.
std::vector<FalseAlarm> strongest(std::vector<FalseAlarm> alarms,
                                  std::span<const std::string> backgrounds);
std::vector<Miss> easiest(std::vector<Miss> misses);

}  // namespace airtruth::scores
