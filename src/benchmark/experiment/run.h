// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>

#include "benchmark/experiment/trajectories.h"
#include "benchmark/tracking/tracker.h"
#include "foundation/base/log.h"
#include "foundation/geometry/box.h"

namespace airtruth::experiment {

struct RunOptions {
  std::string tracker = "am3";  // tracking::make_tracker, or NAME=trax:COMMAND
  Protocol protocol = Protocol::kOnePass;
  int repetitions = 1;   // of restarts; each with the next seed
  int anchor_step = 50;  // frames between starts
  std::uint64_t seed = 1;
  double start_s = 30;     // TraX: longest until a tracker is there
  double answer_s = 30;    // TraX: longest until each answer
  std::string only = "*";  // sequences whose name fits
  int jobs = 1;            // sequences at a time; times a frame are honest with 1 alone
  Warn warn;
  std::function<void(std::int64_t done, std::int64_t total)> progress;  // sequences, or frames
  std::stop_token stop;
};

struct RunSummary {
  fs::path folder;          // of the tracker's results
  std::int64_t made = 0;    // runs
  std::int64_t kept = 0;    // had been made by an earlier call
  std::int64_t broken = 0;  // of those made, ended by a tracker that crashed or hung
  std::int64_t frames = 0;  // with an answer
  double seconds = 0;       // of the tracker alone, without its starts
};

// Runs a tracker over every sequence of a data set, begun on its truth. Each object of a sequence
// is tracked by itself, from the first frame that shows it whole to the last that shows it (NAME-1,
// NAME-2, ... where there are several, as exports of single-object formats have them).
//   one pass:   begun on the first frame and never helped again (OTB's OPE)
//   restart:    after an answer that does not touch the truth, begun anew 5 frames later (VOT2013)
//   multistart: from every anchor to the end or backward to the beginning (VOT2020)
// Leaves results in out/TRACKER (trajectories.h), tracker.json that says how they came about, and
// logs/SEQUENCE.log of what a TraX tracker said beside its answers. The seconds are the tracker's
// own: from the picture in the form that it takes to its answer, without decoding, conversion and,
// for TraX, writing the picture; reading it is in them. A run's results appear whole or not at all;
// what is there is not made again. A tracker that breaks gives no more answers in that run; Error
// where it cannot be started at all, or where `out` holds results of other settings.
RunSummary run(const fs::path& set, const fs::path& out, const RunOptions& options);

// Error for what run() would refuse before the first frame: no such tracker, or results of other
// settings in `out`. A TraX tracker without a name is started to ask it for its own.
void check_run(const fs::path& out, const RunOptions& options);

// The same, one pass, over a video without truth, from a box in `first_frame` to its end:
// out/TRACKER/VIDEO.txt.
RunSummary run_on_video(const fs::path& video,
                        const Box& init,
                        std::int64_t first_frame,
                        const fs::path& out,
                        const RunOptions& options);

}  // namespace airtruth::experiment
