// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "dataset/catalogue/expand.h"
#include "dataset/sequences/layout.h"
#include "foundation/base/files.h"
#include "foundation/base/log.h"

// Makes the folder of a data set (docs/formats/dataset.md; catalogue::Folder has its paths).
namespace airtruth::build {

struct BuildProgress {
  // Sequences of this run's share that were made, or found whole.
  std::int64_t done = 0;
  std::int64_t total = 0;  // sequences of this run's share
  // "building", or the work that is done on a background's frames.
  std::string stage;
};

struct BuildOptions {
  // Number of sequences that are made at the same time; 0 means one per core.
  int jobs = 0;
  // Pattern; only sequences with a matching name are made.
  std::string only = "*";
  // A set of more sequences that is begun now has them in numbered folders with as many each.
  std::int64_t max_in_a_folder = sequences::kMaxSequencesInAFolder;
  // Maps a background's name to the video that replaces the catalogue's.
  std::map<std::string, fs::path> videos;
  // This run makes the sequences whose number is congruent to `share` modulo `shares`.
  std::int64_t share = 0;
  std::int64_t shares = 1;
  std::function<void(const BuildProgress&)> progress;
  Warn warn;
  std::stop_token stop;
};

struct Failure {
  std::string name;
  std::string reason;  // one line
};

struct BuildSummary {
  std::int64_t made = 0;
  std::int64_t kept = 0;    // sequences that were already whole
  std::int64_t frames = 0;  // frames of the sequences that were made
  std::vector<Failure> failures;
  // True where every sequence of the catalogue exists; the manifest is then written.
  bool complete = false;
  double seconds = 0;
};

// Makes the missing sequences. A build that was killed at any instant continues at the next call: a
// sequence's folder exists whole or not at all, and whole sequences are kept. A sequence that fails
// is listed in `failures`, and the build continues with the others. Throws Error where `out` was
// begun with another catalogue, another build is at work in it, the first whole sequence over a
// background was made of other files than are there now, the video of a background cannot be read,
// no sequence's name matches the pattern, or the disk is full or read-only. Throws Interrupted on
// stop.
BuildSummary build_set(const catalogue::Catalogue& catalogue,
                       const fs::path& out,
                       const BuildOptions& options);

// Writes the manifest of a folder that several workers have filled. Returns false where a sequence
// is missing. Throws Error while any worker is active.
bool finish(const fs::path& root);

}  // namespace airtruth::build
