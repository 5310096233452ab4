// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "evaluation/detector_evaluation/assess.h"

// The part of `airtruth evaluate` that is for detectors' results.
namespace airtruth::cli {

struct EvaluateDetections {
  detector_evaluation::AssessOptions options;
  std::string ignore;
  // MOTChallenge text is a detector's, also where it has tracks.
  bool is_detections = false;

  // Which of the results are a detector's.
  bool holds(const std::filesystem::path& results) const {
    return detector_evaluation::holds_detections(results, is_detections);
  }
};

// A cell of a table of results, "-" where nothing was measured.
std::string number(const std::optional<double>& value, int digits);

void add_detection_options(CLI::App& command, EvaluateDetections& arguments);

void print_detections(const scores::Assessment& assessment, Console& console);

}  // namespace airtruth::cli
