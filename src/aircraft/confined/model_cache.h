// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "aircraft/model/load_options.h"
#include "aircraft/model/raw_model.h"
#include "aircraft/wrapper/model_files.h"
#include "foundation/base/files.h"
#include "foundation/disk_cache/disk_cache.h"

// Converted untrusted models in the cache. The model file's bytes, the options and the reader's
// program identify an entry, which lists every other requested file with the SHA-256 of its
// content. An entry is used where all of these files are unchanged, and it is checked like the
// result of a reader.
namespace airtruth::confined {

// The key of a model; empty where it cannot be read. Asks `files` for the model file's bytes.
std::optional<disk_cache::Key> model_key(wrapper::DiskFiles& files,
                                         const fs::path& file,
                                         const model::LoadOptions& options);

// The model of the entry. Empty where there is no sound entry, or where a file has changed.
// Otherwise files.sources() lists the files that the model was made from.
std::optional<model::RawModel> cached_model(const disk_cache::Key& key, wrapper::DiskFiles& files);

// Keeps a model that was read from `files`, which must have recorded its requests.
void keep_model(const disk_cache::Key& key,
                const wrapper::DiskFiles& files,
                const model::RawModel& model);

}  // namespace airtruth::confined
