// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <airtruth/aot.h>
#include <airtruth/average_precision.h>
#include <airtruth/froc.h>
#include <airtruth/track_measures.h>

#include "evaluation/measures/bearing_error.h"
#include "evaluation/scores/breakdown.h"
#include "evaluation/scores/declaration.h"
#include "evaluation/scores/detection_match.h"
#include "evaluation/scores/galleries.h"
#include "evaluation/scores/truth.h"
#include "evaluation/statistics/proportion.h"
#include "runners/results/detections.h"

// The whole assessment of detectors on a data set: what tables and pages show. It is a value; no
// file is needed to make or read it.
namespace airtruth::scores {

// The measures of whole tracks; detectors whose results have detections without tracks alone, which
// nothing associated, have none.
struct TrackScores {
  evaluation::Hota hota;
  evaluation::ClearMot clear;
  evaluation::Identity identity;
  // False tracks of all results, and per hour.
  std::int64_t false_tracks = 0;
  double false_tracks_per_hour = 0;
  // One for each aircraft of each scored sequence.
  std::vector<EncounterScore> encounters;
  DeclarationSummary declarations;
  // With the set's encounter weights; empty where no sequence has a weight.
  std::optional<DeclarationSummary> weighted_declarations;
  // By falling score.
  std::vector<OperatingPoint> operating_curve;
};

struct DetectorScore {
  std::string name;
  // In the order of the truths; a sequence without results is left out of every measure.
  std::vector<ScoredDetections> sequences;
  std::int64_t detections = 0;

  evaluation::AveragePrecision average_precision;
  evaluation::Froc froc;
  // The threshold of `by`, bearings, false alarms and misses, and what holds there.
  evaluation::FrocPoint point;
  // The probability of detection at the point with the set's encounter weights; empty where no
  // sequence has a weight.
  std::optional<statistics::Proportion> weighted_detection;
  // Keys: quantities(). A key without a value anywhere is not there.
  std::map<std::string, std::vector<DetectionBin>> by;
  // False alarms at the point by what they are: "background", "bird", ... with their number.
  std::map<std::string, std::int64_t> false_alarms_by;
  // Shares of other objects' frames that raised one: by class.
  std::map<std::string, statistics::Proportion> mistaken_by;
  std::optional<measures::BearingError> bearing;
  evaluation::AotScore aot;
  evaluation::AotRanks aot_ranks;
  std::optional<TrackScores> tracks;
  // At the point; the strongest first, at most kGallerySize.
  std::vector<FalseAlarm> false_alarms;
  std::vector<Miss> misses;
  // Seconds of the detector for each frame, over all frames with a time; empty where unknown.
  std::optional<double> frames_per_second_median;
};

struct ScoreOptions {
  // Radius of matching/boxes.h.
  double centre_px = 10;
  // The operating point: this score for all detectors, else the least score with at most as many
  // false alarms an image.
  std::optional<double> score;
  double false_alarms_per_image = 0.1;
  // Seconds that a manoeuvre needs before the volume is violated. Needs `volume`.
  std::optional<double> manoeuvre_s;
  // Name of a volume (encounter/separation/violation.h, or the scenes' own); empty: none.
  std::string volume;
  // True: encounters and the probability of detection also get weighted shares, with
  // TruthSequence::weight.
  bool is_weighted = false;
};

struct Assessment {
  std::string set;                    // name of the data set's folder
  std::vector<TruthSequence> truths;  // sorted by name
  // In order of decreasing AP at the centre distance.
  std::vector<DetectorScore> detectors;
  ScoreOptions options;
  // The conditions that the sequences meet, as they were asked for.
  std::vector<std::string> where;
  // What the truth lacks, as sentences for people: "No range is known: ...".
  std::vector<std::string> left_out;

  bool empty() const { return detectors.empty(); }
};

// What a sequence contributes to the FROC; it has its matches.
evaluation::FrocSequence froc_sequence_of(const TruthSequence& truth,
                                          const ScoredDetections& scored);

// All measures of one detector. `sequences` state their truth and detections; their matches are
// made here. Each has as many frames as its truth. `is_associated`: tracks were made of the
// detections, be there any or not.
DetectorScore score_detector(std::string name,
                             std::vector<ScoredDetections> sequences,
                             bool is_associated,
                             std::span<const TruthSequence> truths,
                             const ScoreOptions& options);

}  // namespace airtruth::scores
