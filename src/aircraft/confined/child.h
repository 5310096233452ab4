// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aircraft/model/load_options.h"
#include "aircraft/model/raw_model.h"
#include "aircraft/wrapper/model_files.h"
#include "foundation/base/files.h"

// Untrusted models are read in a child process, airtruth-model-reader, which can only return plain
// arrays: see foundation/sandbox.
namespace airtruth::confined {

// The wall time in seconds after which the child is ended. Chosen: the largest aircraft of the
// catalogue are read in a small part of it.
constexpr double kReaderSeconds = 20;

// Reads a model as read_model does, in a child process. `file` lies below the folder of `files`,
// which is the only place the child receives files from. Throws Error where the child reports one,
// crashes or takes longer than kReaderSeconds, and where its result fails check_model. Throws
// Interrupted within 0.1 s where options.stop is requested. The child has ended when the function
// returns or throws.
model::RawModel read_in_child(wrapper::DiskFiles& files,
                              const fs::path& file,
                              const model::LoadOptions& options);

// The path of the child's program: $AIRTRUTH_MODEL_READER, else airtruth-model-reader beside this
// program, in ../libexec/airtruth from it, in PREFIX/libexec/airtruth for a libairtruth.so in
// PREFIX/lib, or in the configured place of installation. Throws Error where none of these exists.
fs::path model_reader_program();

}  // namespace airtruth::confined
