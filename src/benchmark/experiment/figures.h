// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "benchmark/experiment/assess.h"

namespace airtruth::experiment {

// Writes the page's plots as files for a paper into out/figures: success, precision, normalised,
// eao, range_m, size_px, contrast, background and ranking (evaluation_plots.h). For each sequence
// it adds xy-NAME (X, Y and the error over the frames, as in Figure 11 of the E-Vision paper) and,
// where the videos were read, frames-NAME.png (pictures with boxes, as in its Figure 12). `format`
// is "png", "pdf" or "svg". The gnuplot script of each plot, including its data, lies beside the
// plot.
void write_figures(const Assessment& assessment,
                   const std::filesystem::path& out,
                   const std::string& format);

// Throws Error for any other format, and where the program gnuplot is missing, before any work
// begins.
void check_figures(const std::string& format);

}  // namespace airtruth::experiment
