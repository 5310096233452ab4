// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>

#include "base/log.h"

namespace airtruth::dataset {

namespace fs = std::filesystem;

struct TrackOptions {
  std::string tracker = "am3";  // tracking::make_tracker
  std::uint64_t seed = 1;
  std::string only = "*";  // sequences whose name fits
  int jobs = 1;            // sequences at a time; times a frame are honest with 1 alone
  Warn warn;
  std::function<void(std::int64_t done, std::int64_t total)> progress;  // sequences
  std::stop_token stop;
};

struct TrackSummary {
  std::int64_t made = 0;
  std::int64_t kept = 0;  // had been made by an earlier run
  std::int64_t frames = 0;
  double seconds = 0;  // of the tracker alone, over the frames after each first
};

// Runs a tracker over every sequence of a data set, one pass (OTB's OPE): begun on the truth of the
// first frame that shows the object, and never helped again. Leaves out/TRACKER/SEQUENCE.txt, a
// line "x,y,w,h" a frame from that one to the last that shows it (pixels from 0), and
// SEQUENCE_time.txt, the seconds of each answer: of the tracker's own work, without decoding and
// conversion to the form that it takes. Sequences with several objects have one result each,
// NAME-1, NAME-2, ... (as exports of single-object formats). A sequence's results appear whole or
// not at all; what is there is not made again.
TrackSummary track(const fs::path& set, const fs::path& out, const TrackOptions& options);

}  // namespace airtruth::dataset
