// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "evaluation/report/run_options.h"
#include "evaluation/scores/detector_score.h"

// The page of an evaluation of detectors, and its plots for papers.
namespace airtruth::detector_evaluation {

// Writes out/detection.html: a table of the detectors with intervals, the curves, probability of
// detection by range and other quantities, a player of every sequence with truth, detections and
// tracks drawn, and galleries of false alarms and misses. The page needs no network.
void write_page(const scores::Assessment& assessment,
                const std::filesystem::path& out,
                const report::RunOptions& run);

// Writes the plots (plots.h) into out/figures as detection_NAME.png, .pdf or .svg, each
// with its gnuplot script and data beside it, and detection_ranking, the average precisions with
// their intervals.
// Throws Error where `format` is another.
void write_figures(const scores::Assessment& assessment,
                   const std::filesystem::path& out,
                   const std::string& format);

}  // namespace airtruth::detector_evaluation
