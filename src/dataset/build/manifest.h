// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "dataset/build/build.h"
#include "dataset/catalogue/folder.h"

namespace airtruth::dataset {

// A line each; the file is removed where nothing failed.
void write_failures(const fs::path& file, const std::vector<Failure>& failures);

// manifest/*.jsonl and, last, dataset.json, where every sequence of the catalogue is there (else
// false, and neither is written). Memory does not grow with the number of sequences. The same bytes
// for any number of workers.
bool write_manifest(const Catalogue& catalogue, const Folder& folder);

}  // namespace airtruth::dataset
