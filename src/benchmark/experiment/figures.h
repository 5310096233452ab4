// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "benchmark/experiment/assess.h"

namespace airtruth::experiment {

// The page's plots as files for a paper, in out/figures: success, precision, normalised, eao,
// ranking, range_m, size_px and contrast; for each sequence xy-NAME (X, Y and the error over the
// frames, as the E-Vision paper's Figure 11) and frames-NAME.png (pictures with boxes, its Figure
// 12; where the videos were read). `format`: "png", "pdf" or "svg". Beside each plot lies the
// gnuplot script, data included, that made it.
void write_figures(const Assessment& assessment,
                   const std::filesystem::path& out,
                   const std::string& format);

// Error for another format, and where the program gnuplot is not there: before anything is done.
void check_figures(const std::string& format);

}  // namespace airtruth::experiment
