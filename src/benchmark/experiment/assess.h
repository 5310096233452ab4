// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "benchmark/experiment/truth.h"
#include "foundation/base/log.h"
#include "truth/evaluation/metrics.h"
#include "truth/evaluation/outcome.h"
#include "truth/evaluation/statistics.h"
#include "truth/evaluation/vot.h"

namespace airtruth::experiment {

namespace fs = std::filesystem;

// What is compared, ranked and given an interval: a number of a sequence's score.
struct Measure {
  const char* name;
  double evaluation::Score::*value;
  bool more_is_better;
  bool weighs_by_frames;         // GOT-10k's are over all frames together
  bool zero_is_unknown = false;  // sequences without the number are left out
};
const std::vector<Measure>& measures();

// Where a tracker lost its object for the first time.
struct Loss {
  std::int64_t frame = 0;  // of the video
  std::optional<double> time_s;
  std::optional<double> range_m;
};

struct ScoredSequence {
  std::size_t truth = 0;  // index of its TruthClip
  std::string name;
  std::vector<std::optional<Box>> answers;  // of the one pass; empty without it
  std::optional<evaluation::Score> score;
  std::vector<evaluation::Outcome> outcomes;
  std::optional<Loss> loss;
  std::optional<evaluation::Restart> restart;
  std::optional<evaluation::MultiStart> multistart;
};

struct ScoredTracker {
  std::string name;
  std::vector<ScoredSequence> sequences;
  std::optional<evaluation::Score> overall;                              // of the one passes
  std::map<std::string, std::optional<evaluation::Interval>> intervals;  // by measure
  // Mean angle between the rays to the answers and to the truth.
  std::optional<double> angle_mrad;
  std::int64_t lost = 0;  // sequences in which it lost its object
  // By "range_m", "size_px", "contrast"; and by the background's name.
  std::map<std::string, std::vector<evaluation::Bin>> bins;
  std::map<std::string, evaluation::Bin> backgrounds;
  std::optional<evaluation::Restart> restart;
  std::optional<evaluation::MultiStart> multistart;
};

struct Comparison {
  std::string a, b;
  std::int64_t sequences = 0;  // that both have
  evaluation::Paired auc;
};

struct Assessment {
  std::string set;  // name of the data set's folder
  std::vector<TruthClip> truths;
  std::vector<ScoredTracker> trackers;  // best AUC first
  std::vector<Comparison> comparisons;  // of each pair
  std::pair<int, int> eao_range{};      // frames
  bool until_loss = false;              // of the frames per second: AssessOptions
};

struct AssessOptions {
  int origin_px = 0;                             // what the results call the first pixel, 0 or 1
  std::optional<std::pair<int, int>> eao_range;  // else by the data set's lengths
  bool until_loss = false;                       // frames per second without the frames from the
                                                 // first loss on
  bool with_film = true;                         // contrast and stills, for which videos are read
  int jobs = 0;                                  // 0: one per core
  Warn warn;
  std::function<void(std::int64_t done, std::int64_t total)> progress;  // videos read
  std::stop_token stop;
};

// Scores folders of results (trajectories.h; a folder's name is its tracker's) against a data set.
// Warns of results for sequences that the set has not, and of sequences without a result, which are
// left out of that tracker's score. Error for a folder without a result for any sequence, and for
// two of one name.
Assessment assess(const fs::path& set,
                  const std::vector<fs::path>& results,
                  const AssessOptions& options);

// evaluation.json, trackers.csv, sequences.csv and breakdown.csv, in a folder.
void write_tables(const Assessment& assessment, const fs::path& out);

// Kendall's tau of the AUCs of the trackers that this evaluation and another evaluation.json share.
struct Agreement {
  std::vector<std::string> trackers;
  std::optional<double> tau;
};
Agreement agreement(const Assessment& assessment, const fs::path& other);

// Error where the file is no evaluation.json: to know it before an evaluation, not after.
void check_evaluation(const fs::path& file);

}  // namespace airtruth::experiment
