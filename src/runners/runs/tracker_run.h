// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "foundation/base/files.h"
#include "foundation/base/log.h"
#include "foundation/geometry/box.h"
#include "runners/results/trajectories.h"
#include "runners/tracking/tracker.h"

namespace airtruth::runs {

struct TrackOptions : tracking::TrackerOptions {
  std::string tracker = "am3";  // tracking::make_tracker, or NAME=trax:COMMAND
  results::Protocol protocol = results::Protocol::kOnePass;
  // Repetitions of the restart protocol; each uses the next seed.
  int repetitions = 1;
  int anchor_step = 50;  // distance between starts in frames
  // Pattern for the names of the sequences that are run.
  std::string only = "*";
  // Number of sequences at the same time; times per frame are meaningful only with 1.
  int jobs = 1;
  Warn warn;
  std::function<void(std::int64_t done, std::int64_t total)>
      progress;  // counts sequences, or frames
};

struct TrackSummary {
  fs::path folder;          // folder of the tracker's results
  std::int64_t made = 0;    // runs with results
  std::int64_t kept = 0;    // runs that an earlier call had made
  std::int64_t broken = 0;  // runs that the tracker did not finish; they have no results
  std::int64_t frames = 0;  // frames with an answer
  double seconds = 0;       // time of the tracker alone, without its starts
};

// Runs a tracker over every sequence of a data set; the truth gives the first box. Each object of a
// sequence is tracked separately, from the first frame that shows it whole to the last frame that
// shows it (NAME-1, NAME-2, ... where there are several objects, as in exports to single-object
// formats).
//   one pass:   starts on the first frame and is never restarted (OTB's OPE)
//   restart:    restarts 5 frames after an answer that does not touch the truth (VOT2013)
//   multistart: starts at every anchor and runs to the end, or backward to the beginning (VOT2020)
// Writes results into out/TRACKER (trajectories.h), tracker.json with the settings of the run,
// beside each run's results RUN.run.json with what names the content of its sequence, and
// logs/SEQUENCE.log with a TraX tracker's output beside its answers. The seconds are the tracker's
// own: they begin with the picture in the tracker's own form and end with the answer. They exclude
// decoding, conversion and, for TraX, writing the picture, but include reading it. The results of a
// run appear whole or not at all, and existing results are kept. A run in which the tracker fails
// has none, and the next call tries it again. Throws Error where the tracker cannot be started at
// all, or where `out` holds results of other settings or of other content under a sequence's name,
// or runs of a sequence that these options do not make, which evaluation would take.
TrackSummary track(const fs::path& set, const fs::path& out, const TrackOptions& options);

// Throws Error in the cases in which track() fails before the first frame: no such tracker, or
// results of other settings in `out`. A TraX tracker without a name is started to report its own.
void check_track(const fs::path& out, const TrackOptions& options);

// Runs one pass over a video without truth, from a box in `first_frame` to the end, and writes
// out/TRACKER/VIDEO.txt and, with the video's path, its content's SHA-256 and the first frame,
// VIDEO.run.json. Throws Error where `out` holds results of another video of that name or of other
// content, or from another frame or box.
TrackSummary track_video(const fs::path& video,
                         const Box& init,
                         std::int64_t first_frame,
                         const fs::path& out,
                         const TrackOptions& options);

}  // namespace airtruth::runs
