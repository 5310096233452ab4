// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "dataset/build/build.h"
#include "dataset/catalogue/folder.h"

namespace airtruth::build {

// Writes one line per failure. The file is removed where nothing failed.
void write_failures(const fs::path& file, const std::vector<Failure>& failures);

// Writes manifest/*.jsonl and, last, dataset.json. Returns false and writes neither where a
// sequence of the catalogue is missing. Memory does not grow with the number of sequences. The
// bytes do not depend on the number of workers.
bool write_manifest(const catalogue::Catalogue& catalogue, const catalogue::Folder& folder);

}  // namespace airtruth::build
