// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "aircraft/model/load_options.h"
#include "aircraft/model/raw_model.h"
#include "aircraft/wrapper/model_files.h"

// A cache of converted untrusted models. The model file's bytes and the options identify an entry,
// which lists every other requested file with the SHA-256 of its content. An entry is used where
// all of these files are unchanged, and it is checked like the result of a reader.
namespace airtruth::aircraft {

struct ModelCache {
  std::filesystem::path folder;  // cache_folder() / "models"
  std::string name;              // of the entry; empty: the model file cannot be read
};

// Asks `files` for the model file's bytes.
ModelCache model_cache(DiskFiles& files, const fs::path& file, const LoadOptions& options);

// The model of the entry. Empty where there is no entry, where it is incomplete, or where a file
// has changed. Otherwise files.sources() lists the files that the model was made from.
std::optional<RawModel> cached_model(const ModelCache& cache, DiskFiles& files);

// Writes an entry for a model that was read from `files`, which must have recorded its requests. A
// cache that cannot be written is no error: the model is read again the next time.
void keep_model(const ModelCache& cache, const DiskFiles& files, const RawModel& model);

}  // namespace airtruth::aircraft
