// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "foundation/base/files.h"
#include "foundation/base/log.h"
#include "runners/association/associator.h"
#include "runners/process/child.h"

namespace airtruth::runs {

// The network that ships in data/network-detector.
inline constexpr const char* kShippedDetector = "network";

// The names of the built-in detectors.
std::vector<std::string> detector_names();
// The forms of the others, with what they are, for --help and errors.
std::vector<std::string> detector_forms();
bool is_program(const std::string& detector);  // also for "NAME=exec:COMMAND"

// The limits are for external programs.
struct DetectOptions : process::Limits {
  // "mine=exec:./mine --fast" is the command "exec:./mine --fast" whose results are named "mine";
  // without a name they are named as the command up to its colon, and those of
  // onnx:DIR/aircraft.onnx "aircraft".
  std::vector<std::string> detectors;
  // Pattern for the names of the sequences.
  std::string only = "*";
  // Number of sequences at the same time.
  int jobs = 1;
  // Detections with a lower score are not written; empty: all are.
  std::optional<double> min_score;
  // Of each frame, those with the highest scores are written.
  int max_per_frame = 100;
  // The backgrounds of a made set as well: pictures without an intruder. No evaluation reads their
  // results: its figures are of the frames of the set's sequences.
  bool backgrounds = false;
  // Calibration file for clips that state no lens.
  std::optional<fs::path> lens;
  // Frames a second of pictures that state none.
  std::optional<double> frame_rate_hz;
  // Mask of the own aircraft for clips that state none.
  std::optional<fs::path> mask;
  // Masks are used: nothing is detected on the own aircraft, and the camera's motion is not
  // measured on it.
  bool masks = true;
  // Detections of detectors that do not look at the mask (networks, programs) are left out where
  // more than half of their box is on the own aircraft.
  bool mask_results = false;
  // Tracks made of the detections; empty: the detector's own, if it has any. Without a confident
  // score it is the detector's.
  std::optional<association::AssociationOptions> association;
  Warn warn;
  // Counts sequences, or frames of a single video.
  std::function<void(std::int64_t done, std::int64_t total)> progress;
};

// What a run made of one detector's results.
struct DetectSummary {
  std::string name;
  fs::path folder;
  std::int64_t made = 0;    // sequences
  std::int64_t kept = 0;    // sequences that an earlier call had made
  std::int64_t broken = 0;  // sequences that the detector did not finish; they have no results
  std::int64_t frames = 0;  // of those made
  std::int64_t detections = 0;
  double seconds = 0;  // the detector's own time for those frames
};

// True for a data set, and false for a video. A folder without sequences is one of pictures, unless
// it is a set that is still empty. Throws Error for what is not there.
bool is_set(const fs::path& source);

// Runs detectors over every frame of every sequence of a set, or of one video, and writes
// out/DETECTOR/ (results_folder.h) and logs/SEQUENCE.log with what a program printed. The results
// of backgrounds lie in a folder of their own, out/DETECTOR/backgrounds/PART.txt and .json, since
// the set has no sequence of that name. A frame is decoded, and the camera's motion measured, once
// for all detectors. The results of a sequence appear whole or not at all, and existing ones are
// kept; detections.json is written once all sequences of the set are there. A detector that fails
// within a sequence leaves it without results, and goes on with the next. The results do not depend
// on `jobs`, but for the seconds. Throws Error where there is nothing to run over, where a detector
// is unknown or cannot be made, and where `out` holds results of other settings or
// of other content under a sequence's name.
std::vector<DetectSummary> detect(const fs::path& source,
                                  const fs::path& out,
                                  const DetectOptions& options);

}  // namespace airtruth::runs
