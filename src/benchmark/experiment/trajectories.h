// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "truth/evaluation/vot.h"
#include "truth/exchange/labels.h"

// Trackers' results as files (docs/evaluation.md). A folder holds one tracker's:
//   SEQUENCE.txt                              one pass, a line "x,y,w,h" a frame
//   SEQUENCE_time.txt                         its seconds
//   restart/SEQUENCE/SEQUENCE_001.txt         VOT's runs with restarts: a box, or 1 where it was
//                                             begun, 2 where it failed, 0 for frames passed over
//   multistart/SEQUENCE/SEQUENCE_00000050.txt VOT's runs from an anchor
//   .../SEQUENCE_001_time.value               their seconds
// What others write is read as well: VOT's folder "baseline" in place of the last two, its binary
// runs (SEQUENCE_001.bin, vot_regions.h) and times with blank lines, GOT-10k's
// SEQUENCE/SEQUENCE_001.txt, and MOTChallenge's SEQUENCE.txt.
namespace airtruth::experiment {

namespace fs = std::filesystem;

enum class Protocol { kOnePass, kRestart, kMultiStart };
// "ope", "restart", "multistart"; Error with the nearest for anything else.
Protocol protocol_from_name(std::string_view name);
const char* name(Protocol protocol);

// `number`: of the repetition from 1, or of the anchor's frame; nothing for one pass.
fs::path trajectory_file(const fs::path& folder,
                         Protocol protocol,
                         const std::string& sequence,
                         std::int64_t number);
fs::path times_file(const fs::path& trajectory, Protocol protocol);

// An answer without a box is "nan,nan,nan,nan".
std::string text_of(const evaluation::Trajectory& trajectory);
std::string text_of(const std::vector<double>& seconds);  // to the nanosecond

// What a folder holds for a sequence.
struct Results {
  struct Run {
    evaluation::Trajectory frames;
    std::vector<double> seconds;  // empty where there are none
    fs::path file;
  };
  std::vector<Run> one_pass;  // at most one
  std::vector<Run> restart;
  std::vector<Run> multistart;
  std::vector<std::int64_t> anchors;  // of multistart
  bool empty() const { return one_pass.empty() && restart.empty() && multistart.empty(); }
};

// `origin_px`: what the results call the first pixel, 0 or 1 (MOTChallenge's: always 1). Boxes that
// have no area are answers without a box, those with a NaN too in one pass; in
// VOT's runs they are kUnknown, as in its toolkit. Polygons and masks become the box that bounds
// them. Of MOTChallenge's tracks it takes the one that overlaps the truth most where any first
// does. Error at file and line for what is no result, for runs of another length than the clip, and
// for times of another length than their run.
Results read_results(const fs::path& folder, const exchange::Clip& clip, int origin_px);

// Sequences that a folder has results for, sorted.
std::vector<std::string> sequences_in(const fs::path& folder);

}  // namespace airtruth::experiment
