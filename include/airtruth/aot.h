// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <airtruth/box.h>
#include <airtruth/export.h>

// The metrics of Amazon's Airborne Object Tracking challenge, as its public code computes them
// (airborne-detection-starter-kit, core/metrics: match_groundtruth_results.py,
// calculate_encounters.py, calculate_airborne_metrics.py).
//
// A detection matches an object at an extended overlap of 0.2 or more and is away from it below
// 0.02. For an object below 100 px^2, the object and a detection below 100 px^2 are first enlarged
// about their centres to 100 px^2, each at its own aspect. A detection that is away from every
// object of its frame, birds included, is false.
//
// An encounter is a run of frames that show an object with a range of at most 700 m, in the order
// of (flight, object, frame); it ends at a gap of more than 3 frames. It is valid with 30 frames or
// more and a least range of at most 330 m. It is detected from the first frame on at which, of the
// latest 30 frames of the encounter, one track matches in 15 or more: that frame has a range of
// 300 m or more, or is within the first 30 frames. Two properties of the code are kept: an object
// whose frames begin within 3 frames of the end of the object before it continues that object's
// encounter; and a track that matches twice in one frame counts twice.
namespace airtruth::evaluation {

struct AotObject {
  std::int64_t id = 0;
  Box box_px;
  std::optional<double> range_m;
  // -1 below the horizon, 1 above, 0 on it.
  int above_horizon = 0;
};
struct AotDetection {
  Box box_px;
  double score = 0;
  // Empty: a track of its own.
  std::optional<std::int64_t> track;
};
struct AotFrame {
  std::int64_t frame = 0;
  std::vector<AotObject> objects;
  std::vector<AotDetection> detections;
};
struct AotFlight {
  std::vector<AotFrame> frames;
};

struct AotRate {
  std::int64_t detected = 0;
  std::int64_t total = 0;
  // 0 for a total of 0, as in the code.
  double rate() const {
    return total == 0 ? 0 : static_cast<double>(detected) / static_cast<double>(total);
  }
};

struct AotScore {
  double score = 0;  // detections with this score or more
  // Encounter detection rate: by tracks, and by frames (any track).
  AotRate edr_all, edr_below, edr_mixed, edr_above;
  AotRate edr_frames_all;
  // Airborne frame detection rate: of objects in range (up to the largest range within valid
  // encounters).
  AotRate afdr;
  std::optional<double> max_range_m;  // empty: no valid encounter
  // False tracks an hour; false positives an image.
  double hfar = 0;
  double fppi = 0;
};

struct AotOptions {
  std::optional<double> min_score;
  // Hours of all flights together; the challenge counts two minutes for each flight.
  double hours = 0;
  // Detections of tracks with fewer frames so far do not count.
  int min_track_frames = 0;
};
AIRTRUTH_API AotScore aot_score(std::span<const AotFlight> flights, const AotOptions& options);

// The ranks of the challenge: EDR at the least score with HFAR of at most 0.5 an hour, and AFDR at
// the least score with FPPI of at most 0.0005. Empty where no score does it.
constexpr double kRankedHfar = 0.5;
constexpr double kRankedFppi = 0.0005;
struct AotRanks {
  std::optional<AotScore> by_hfar;
  std::optional<AotScore> by_fppi;
};
AIRTRUTH_API AotRanks aot_ranks(std::span<const AotFlight> flights, double hours);

}  // namespace airtruth::evaluation
