// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "aircraft/model/load_options.h"
#include "aircraft/model/raw_model.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"

// Untrusted models are read in a child process, airtruth-model-reader, which can only return plain
// arrays: see foundation/sandbox.
//
// What it returns is kept in the cache. The model file's bytes, the options and the reader's
// program identify an entry, which lists every other requested file with the SHA-256 of its
// content. An entry is used where all of these files are unchanged, and it is checked like the
// result of a reader.
namespace airtruth::confined {

// The wall time in seconds after which the child is ended. Chosen: the largest aircraft of the
// catalogue are read in a small part of it.
constexpr double kReaderSeconds = 20;

// Where a model lies: its files as wrapper::DiskFiles takes them, and its own path below their
// folder.
struct ModelPlace {
  fs::path folder;
  fs::path in_data_root;
  fs::path file;
  LetterCase letter_case = LetterCase::kMatters;
};

// Reads a model as read_model does, in a child process, or takes it from the cache. The child
// receives files from the folder alone. `sources` receives every file that the model was read from.
// Throws Error where the child reports one, crashes or takes longer than kReaderSeconds, and where
// its result fails check_model. Throws Interrupted within 0.1 s where options.stop is requested.
// The child has ended when the function returns or throws.
model::RawModel read_in_child(const ModelPlace& place,
                              const model::LoadOptions& options,
                              std::vector<fs::path>& sources);

// The path of the child's program: $AIRTRUTH_MODEL_READER, else airtruth-model-reader beside this
// program, in ../libexec/airtruth from it, in PREFIX/libexec/airtruth for a libairtruth.so in
// PREFIX/lib, or in the configured place of installation. Throws Error where none of these exists.
fs::path model_reader_program();

}  // namespace airtruth::confined
