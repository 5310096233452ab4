// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "benchmark/experiment/assess.h"
#include "show/plot/plot.h"

// The plots of an evaluation, described once for its page and for the figures of a paper.
namespace airtruth::experiment {

// Plots over all sequences by name: success, precision, normalised, eao, range_m, size_px, contrast
// and background. A plot without data is left out.
std::vector<std::pair<std::string, plot::Plot>> evaluation_plots(const Assessment& assessment);

// Mean AUC with its 95 % interval, the first tracker on top; none without scores. The page shows a
// table that can be sorted in its place.
std::optional<plot::Plot> ranking_plot(const Assessment& assessment);

// X, Y and the error of the centre over the frames of the sequence assessment.truths[index].
std::vector<plot::Plot> sequence_plots(const Assessment& assessment, std::size_t index);

// A tracker's answers on a sequence; nullptr where the tracker was not run.
const ScoredSequence* scored(const Assessment& assessment, std::size_t tracker, std::size_t truth);

}  // namespace airtruth::experiment
