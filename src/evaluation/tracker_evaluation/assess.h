// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <airtruth/statistics.h>
#include <airtruth/vot.h>

#include "evaluation/measures/outcome.h"
#include "evaluation/report/run_options.h"
#include "evaluation/tracker_evaluation/truth.h"
#include "foundation/base/files.h"

namespace airtruth::tracker_evaluation {

// The first frame at which a tracker lost its object.
struct FirstLoss {
  std::int64_t frame = 0;  // frame number in the video
  std::optional<double> time_s;
  std::optional<double> range_m;
};

struct ScoredSequence {
  std::size_t truth = 0;  // index in Assessment::truths
  std::string name;
  // Of the one-pass run, of several the first; empty without one.
  std::vector<std::optional<Box>> answers;
  std::optional<evaluation::Score> score;
  std::vector<measures::Outcome> outcomes;
  std::optional<FirstLoss> loss;  // of several runs the first's
  std::optional<evaluation::Restart> restart;
  std::optional<evaluation::MultiStart> multistart;
};

constexpr const char* kBackground = "background";

struct ScoredTracker {
  std::string name;
  std::vector<ScoredSequence> sequences;
  // The score over all one-pass runs.
  std::optional<evaluation::Score> overall;
  // By the measure's name.
  std::map<std::string, std::optional<evaluation::Interval>> intervals;
  // Mean angle between the rays to the answered and to the true positions.
  std::optional<double> angle_mrad;
  // Number of sequences in which the tracker lost its object.
  std::int64_t lost = 0;
  // The keys are "range_m", "size_px" and "contrast", those of the weather that the set states, and
  // kBackground, whose bins have the backgrounds' names.
  std::map<std::string, std::vector<measures::Bin>> bins;
  std::optional<evaluation::Restart> restart;
  std::optional<evaluation::MultiStart> multistart;
};

struct TrackerPair {
  std::string a, b;
  std::int64_t sequences = 0;  // sequences that both trackers have
  evaluation::Paired auc;
};

struct Assessment {
  std::string set;  // name of the data set's folder
  std::vector<TruthClip> truths;
  // In order of decreasing AUC.
  std::vector<ScoredTracker> trackers;
  std::vector<TrackerPair> comparisons;  // one for each pair of trackers
  std::pair<int, int> eao_range{};       // in frames
  // True where frames per second leave out lost frames (AssessOptions).
  bool until_loss = false;
  // The conditions that the sequences meet, as they were asked for.
  std::vector<std::string> where;
};

struct AssessOptions : report::RunOptions {
  // Coordinate that the results give to the first pixel, 0 or 1.
  int origin_px = 0;
  // Empty: the range follows from the lengths of the data set's sequences.
  std::optional<std::pair<int, int>> eao_range;
  // True: frames per second leave out the frames from the first loss on.
  bool until_loss = false;
};

// Scores folders of results (trajectories.h) against a data set. A folder's name is the tracker's
// name. Warns of results for sequences that the set lacks, and of sequences without a result, which
// are left out of that tracker's score. Throws Error for a folder without a result for any
// sequence, and for two folders of the same name.
Assessment assess(const fs::path& set,
                  const std::vector<fs::path>& results,
                  const AssessOptions& options);

// Kendall's tau between the AUCs of this evaluation and of another evaluation.json, over the
// trackers that both contain. tau is 1 for equal rankings and -1 for opposite ones.
//
// Example: three trackers have the AUCs 0.6, 0.5 and 0.4 here and 0.5, 0.6 and 0.4 there. Two of
// the three pairs have the same order and one has the opposite order, so tau = (2 - 1) / 3 = 0.33.
struct Agreement {
  std::vector<std::string> trackers;
  std::optional<double> tau;
};
Agreement agreement(const Assessment& assessment, const fs::path& other);

// Throws Error where the file is not an evaluation.json, so that the fault shows before an
// evaluation begins.
void check_evaluation(const fs::path& file);

}  // namespace airtruth::tracker_evaluation
