// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "evaluation/tracker_evaluation/assess.h"

namespace airtruth::tracker_evaluation {

// Writes report.html into a folder: ranking, curves, breakdowns, pairs of trackers, and for each
// sequence X and Y over its frames beside its pictures (Figures 11 and 12 of the E-Vision paper).
// The page is self-contained.
void write_page(const Assessment& assessment, const std::filesystem::path& out);

// Writes the page's plots as files for a paper into out/figures: success, precision, normalised,
// eao, range_m, size_px, contrast, background and ranking. For each sequence it adds
// xy-NAME (X, Y and the error over the frames, as in Figure 11 of the E-Vision paper) and, where
// the videos were read, frames-NAME.png (pictures with boxes, as in its Figure 12). `format` is
// "png", "pdf" or "svg". The gnuplot script of each plot, including its data, lies beside the plot.
void write_figures(const Assessment& assessment,
                   const std::filesystem::path& out,
                   const std::string& format);

}  // namespace airtruth::tracker_evaluation
