// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <airtruth/average_precision.h>
#include <airtruth/export.h>
#include <airtruth/statistics.h>

// The free-response operating characteristic (Bunch et al. 1977, SPIE 127, 124): probability of
// detection against false alarms, as the threshold on the score falls.
//
// An aircraft in a frame is a trial; it succeeds where a detection with that score or more finds it
// (froc_sequence). False alarms are detections that find nothing and are not ignored;
// several on one aircraft are none.
//
// Example: 10 frames of one sequence at 10 Hz show an aircraft. Detections of score 9 find it in 6
// of them, and one false alarm has score 5. At 9 the probability of detection is 0.6 at 0 false
// alarms; at 5 it is 0.6 at 0.1 an image, 3600 an hour and 1 a flight.
namespace airtruth::evaluation {

inline constexpr double kSecondsPerHour = 3600;

// What one sequence contributes, from its matches.
struct FrocSequence {
  // Of each aircraft in each frame that counts: the highest score that found it; empty: missed at
  // every threshold.
  std::vector<std::optional<double>> best_scores;
  std::vector<double> false_alarm_scores;
  std::int64_t images = 0;
  double duration_s = 0;
};

// Matches the detections of a sequence's images with its aircraft, as `airtruth evaluate` does: a
// detection finds the nearest aircraft whose centre is within `centre_px` or half of the longer
// side of the aircraft's box. One that finds an aircraft to ignore, or lies in a region, counts
// neither way.
AIRTRUTH_API FrocSequence froc_sequence(std::span<const ScoredImage> images,
                                        double duration_s,
                                        double centre_px);

// For each detection of an image whether it counts neither way, by the same matching.
AIRTRUTH_API std::vector<bool> counts_neither_way(const ScoredImage& image, double centre_px);

// True where a detection of this category claims to be an aircraft, as every word does that names
// no other class of object ("bird", "drones").
AIRTRUTH_API bool claims_aircraft(std::string_view category);

struct FrocPoint {
  double score = 0;  // detections with this score or more
  Proportion detection;
  double false_alarms_per_image = 0;
  double false_alarms_per_hour = 0;
  double false_alarms_per_flight = 0;  // a flight is a sequence
};

struct Froc {
  // By falling score; at most `most` points, evenly spread over the false alarms on a logarithmic
  // axis, with the first and the last. Empty without a detection.
  std::vector<FrocPoint> points;
  std::int64_t images = 0;
  std::int64_t flights = 0;
  double hours = 0;
  std::int64_t aircraft = 0;  // trials
};

AIRTRUTH_API Froc froc_of(std::span<const FrocSequence> sequences, std::size_t most = 200);

// The point at exactly this threshold.
AIRTRUTH_API FrocPoint froc_at(std::span<const FrocSequence> sequences, double score);

// The least score whose false alarms per image do not exceed `per_image`, of the scores that occur;
// empty where no score does it.
AIRTRUTH_API std::optional<double> score_at_false_alarms(std::span<const FrocSequence> sequences,
                                                         double per_image);

}  // namespace airtruth::evaluation
