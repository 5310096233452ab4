// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>

namespace airtruth::dataset {

namespace fs = std::filesystem;

struct ReportOptions {
  bool overwrite = false;
  int jobs = 0;  // sequences at a time; 0: one per core
  std::function<void(std::int64_t done, std::int64_t total)> progress;
  std::stop_token stop;
};

// One self-contained page on a data set (a LabelledSet's folder): what is in it, histograms, and
// each sequence with its pictures, its geometry and links to its files. Needs no network. Error
// where `out` exists and is not to be overwritten.
void write_report(const fs::path& set, const fs::path& out, const ReportOptions& options);

}  // namespace airtruth::dataset
