// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "dataset/catalogue/folder.h"
#include "foundation/base/files.h"

namespace airtruth::build {

// The progress of a data set, read from its folder alone.
struct Status {
  std::string name;
  std::int64_t sequences = 0;  // sequences of the catalogue
  std::int64_t whole = 0;
  std::vector<std::string> missing;  // the first hundred names
  std::int64_t not_there = 0;        // how many there are
  // Unfinished sequences of runs that were killed; the next build removes them.
  std::int64_t half = 0;
  // True while a build is running.
  bool at_work = false;
  bool complete = false;  // dataset.json exists, and each sequence
  // By the name of each volume that [truth] asks for: whole sequences in which an intruder violates
  // it at any time, as their records say.
  std::map<std::string, std::int64_t> violated;
};
Status status(const fs::path& root);

struct VerifyOptions {
  // Number of sequences that are verified at the same time; 0 means one per core.
  int jobs = 0;
  // Renders every n-th frame again and compares it (sequence/replay/finished.h), where the files
  // that the sequence was made of are there as they were (sequence/replay/recorded_inputs.h); 0
  // means none.
  std::int64_t deep_every = 0;
  std::function<void(std::int64_t done, std::int64_t total)> progress;
  std::stop_token stop;
};

// The result of checking every file against its checksum, reading every line of truth (boxes lie
// within the frame), comparing the number of video frames with the number of truth lines, and
// comparing the manifest with the sequences, and the inputs of the sequences with one another. Each
// fault is one line; faults are in the order of the catalogue, for any number of jobs. Of missing
// sequences the first ten are faults of their own, and one fault counts the others.
struct VerifyResult {
  std::int64_t sequences = 0;
  std::int64_t frames = 0;
  std::int64_t not_there = 0;   // sequences that are missing
  std::int64_t recomposed = 0;  // frames that were rendered again
  // Counts from geometry alone: an intruder's position is projected through the stated lens and
  // motion, and no pixel is read. in_view counts how often an intruder's reference point lies in
  // the picture. in_view_without_box counts how often there is then no box although nothing hides
  // the intruder; each of these is a fault.
  std::int64_t in_view = 0;
  std::int64_t in_view_without_box = 0;
  std::vector<std::string> faults;
  // The files that the sequences were made of, by name. One that was changed between two of them is
  // a fault.
  struct Input {
    std::string sha256;
    std::string of;  // the first sequence that was made of it
  };
  std::map<std::string, Input> inputs;
};

// A folder without a catalogue is verified by the sequences that are in it: those of `render`
// likewise, and of imported clips that their pictures can be read, their size and number are those
// of the labels, boxes lie in the picture, and labels.jsonl is as long as sequence.json states.
// Throws Error where there is none.
VerifyResult verify(const fs::path& root, const VerifyOptions& options);

}  // namespace airtruth::build
