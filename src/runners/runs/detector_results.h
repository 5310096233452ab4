// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <span>
#include <string>

#include "runners/results/results_folder.h"
#include "runners/runs/detector_run.h"

namespace airtruth::runs {

// The folder of the results of backgrounds, in a detector's folder.
inline constexpr const char* kBackgrounds = "backgrounds";

// The results of one detector in its folder: what is there, what is added. Thread-safe.
class DetectorResults {
 public:
  // Throws Error where the folder holds results of other settings.
  DetectorResults(const DetectorName& detector, const fs::path& out, const DetectOptions& options);

  // Creates the folder and its record.
  void open() const;
  // `part` is "" for the sequences of a set, or kBackgrounds.
  // Counts a sequence that is there.
  bool keeps(const std::string& part, const std::string& sequence);
  void add(const std::string& part,
           const results::SequenceDetections& detections,
           const std::string& log);
  void add_broken(const std::string& sequence, const std::string& fault, const std::string& log);
  // Writes the COCO results of a set of which every sequence is there.
  void finish(std::span<const results::ExpectedSequence> set, const std::string& file_name) const;

  const std::string& command() const { return detector_.command; }
  const DetectSummary& summary() const { return summary_; }

 private:
  bool is_open() const;
  void write_log(const std::string& sequence, const std::string& log) const;

  DetectorName detector_;
  const DetectOptions& options_;
  std::mutex mutex_;
  DetectSummary summary_;
};

}  // namespace airtruth::runs
