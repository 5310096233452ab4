// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stop_token>

#include "foundation/base/files.h"

namespace airtruth::set_report {

struct ReportOptions {
  bool overwrite = false;
  // Number of sequences that are read at the same time; 0 means one per core.
  int jobs = 0;
  // Upper bound for the sequences that the page shows one by one; of a larger set, as many are
  // spread over it. Each takes some 75 kB, and a browser opens a page of 75 MB within seconds.
  std::size_t max_shown = 1000;
  std::function<void(std::int64_t done, std::int64_t total)> progress;
  std::stop_token stop;
};

// Writes one self-contained page about a data set (the folder of a LabelledSet): its contents,
// histograms, and each sequence with its pictures, its geometry and links to its files. Counts are
// of the whole set; contrast is measured in the sequences that are shown. The page needs no
// network. Throws Error where `out` exists and overwrite is false.
void write_report(const fs::path& set, const fs::path& out, const ReportOptions& options);

}  // namespace airtruth::set_report
