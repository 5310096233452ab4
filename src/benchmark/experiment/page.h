// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "benchmark/experiment/assess.h"

namespace airtruth::experiment {

// report.html in a folder: ranking, curves, breakdowns, pairs, and each sequence with X and Y over
// its frames beside its pictures (the E-Vision paper's Figures 11 and 12). Self-contained.
void write_page(const Assessment& assessment, const std::filesystem::path& out);

}  // namespace airtruth::experiment
