// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "benchmark/experiment/assess.h"

namespace airtruth::experiment {

// Writes report.html into a folder: ranking, curves, breakdowns, pairs of trackers, and for each
// sequence X and Y over its frames beside its pictures (Figures 11 and 12 of the E-Vision paper).
// The page is self-contained.
void write_page(const Assessment& assessment, const std::filesystem::path& out);

}  // namespace airtruth::experiment
