// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <airtruth/error.h>
#include <airtruth/labels.h>
#include <airtruth/vot.h>

#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "labels/exchange/exchange.h"

// Trackers' results as files (docs/evaluation.md). A folder holds one tracker's:
//   SEQUENCE.txt                              one pass, a line "x,y,w,h" a frame
//   SEQUENCE_time.txt                         its seconds
//   restart/SEQUENCE/SEQUENCE_001.txt         VOT's runs with restarts: a box, or 1 where it was
//                                             begun, 2 where it failed, 0 for frames passed over
//   multistart/SEQUENCE/SEQUENCE_00000050.txt VOT's runs from an anchor
//   .../SEQUENCE_001_time.value               their seconds
//   .../RUN.run.json                          beside each run, what it was made of
// What others write is read as well: VOT's folder "baseline" in place of the last two, its binary
// runs (SEQUENCE_001.bin, vot_regions.h) and times with blank lines, GOT-10k's repetitions
// SEQUENCE/SEQUENCE_001.txt, ... with a column of times each, and MOTChallenge's SEQUENCE.txt.
namespace airtruth::results {

enum class Protocol { kOnePass, kRestart, kMultiStart };
constexpr auto enum_names(Protocol) {
  return std::to_array<EnumName<Protocol>>({{Protocol::kOnePass, "ope"},
                                            {Protocol::kRestart, "restart"},
                                            {Protocol::kMultiStart, "multistart"}});
}
// Error with the nearest name for one that is unknown.
Protocol protocol_from_name(std::string_view name);

// `number` is the number of the repetition from 1, or the anchor's frame; it is ignored for one
// pass.
fs::path trajectory_file(const fs::path& folder,
                         Protocol protocol,
                         const std::string& sequence,
                         std::int64_t number);
fs::path times_file(const fs::path& trajectory, Protocol protocol);
// The record of what a run was made of.
fs::path run_record(fs::path trajectory);
// Throws Error where the file of one's seconds is that of another's results: a and a_time.
void expect_own_files(const exchange::ArrangedNames& sequences);

// An answer without a box is "nan,nan,nan,nan".
std::string text_of(const evaluation::Trajectory& trajectory);
std::string text_of(const std::vector<double>& seconds);  // to the nanosecond

// The results of one sequence in a folder.
struct TrackerResults {
  struct OnePass {
    evaluation::Trajectory frames;
    std::vector<double> seconds;  // of each frame; 0 where no time exists
  };
  std::optional<OnePass> one_pass;
  std::vector<OnePass> further_passes;  // GOT-10k's repetitions after the first
  std::vector<evaluation::Trajectory> restart;
  std::vector<evaluation::AnchorRun> multistart;
  // Boxes with a width or height below 0, which are answers without a box, and the first's place.
  std::int64_t negative_boxes = 0;
  Where first_negative;
  // How the file of one pass was read, where it fits MOTChallenge and polygons alike; else "".
  std::string doubt;
  // sha256_of_sequence() of the records of the runs; of those that state none, nothing.
  std::set<std::string> sources_sha256;
  bool empty() const { return !one_pass && restart.empty() && multistart.empty(); }
};

// `origin_px` is the coordinate that the results give to the first pixel, 0 or 1 (always 1 for
// MOTChallenge). In one pass, a box without area or with a NaN is an answer without a box. In VOT's
// runs a box without area is an answer without a box, and a box with a NaN is kUnknown, as in VOT's
// toolkit. Polygons and masks become their bounding box. Lines with an even number of columns,
// eight or more, are MOTChallenge's where all begin with a whole frame and id, sorted. Of
// MOTChallenge's tracks the function takes the track that has the greatest overlap with the truth
// at the first frame on which any track overlaps it. Throws Error with file and line for text that
// is not a result, for a run whose length differs from the clip's, and for times whose number
// differs from their run's.
// `first_place` is that of the clip's first frame among the frames of its sequence, by whose places
// from 1 MOTChallenge's lines count.
TrackerResults read_results(const fs::path& folder,
                            const exchange::Clip& clip,
                            int origin_px,
                            std::int64_t first_place = 0);

// The box of a clip's object in a frame; empty where it is not shown.
std::optional<Box> box_of(const exchange::LabelledFrame& frame);
evaluation::VotTruth vot_truth(const exchange::Clip& clip);

// Returns the sorted names of the sequences for which a folder has results.
std::vector<std::string> tracked_sequences_in(const fs::path& folder);

// In the log of a run that was broken off, before the words that say how.
constexpr std::string_view kBrokenOff = "airtruth: the tracker ";
// Returns the sorted names of the runs whose last try was broken off: the stems of their files.
std::vector<std::string> broken_runs_in(const fs::path& folder);

}  // namespace airtruth::results
