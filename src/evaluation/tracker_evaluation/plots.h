// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "evaluation/report/plots.h"
#include "evaluation/tracker_evaluation/assess.h"
#include "show/plot/plot.h"

// The plots of an evaluation as values. report.html and the figures for a paper draw the same ones.
namespace airtruth::tracker_evaluation {

// success, precision, normalised, eao, range_m, size_px, contrast and background: those of them for
// which the assessment holds values. Every tracker has one style in all of them.
std::vector<report::NamedPlot> evaluation_plots(const Assessment& assessment);

// The mean AUC of each tracker with its 95 % interval over sequences, the best on top. Without
// series if no tracker has a one-pass run.
plot::Plot ranking_plot(const Assessment& assessment);

// X, Y and the error of the centre over the frames of assessment.truths[index], in px, as in Figure
// 11 of the E-Vision paper.
std::vector<plot::Plot> sequence_plots(const Assessment& assessment, std::size_t index);

// The run of a tracker (index in assessment.trackers) on a sequence (index in assessment.truths);
// nullptr if it was not run.
const ScoredSequence* scored_sequence(const Assessment& assessment,
                                      std::size_t tracker,
                                      std::size_t truth);

}  // namespace airtruth::tracker_evaluation
