// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "aircraft/model/load_options.h"
#include "aircraft/model/raw_model.h"
#include "aircraft/wrapper/model_files.h"

// Untrusted models are read in a child process, airtruth-model-reader, which can only return plain
// arrays: see src/aircraft/model_reader/confine.h.
namespace airtruth::aircraft {

constexpr double kReaderSeconds = 20;  // wall time after which the child is ended

// As read_model, in a child. `file` lies below the folder of `files`, from which the child gets
// what it asks for. Throws Error where the child says so, crashes, takes too long, or hands back
// what does not hold check_model; Interrupted, within 0.1 s, where options.stop is requested. The
// child is gone when this returns.
RawModel read_in_child(DiskFiles& files, const fs::path& file, const LoadOptions& options);

// The program of the child: $AIRTRUTH_MODEL_READER, else airtruth-model-reader beside this program,
// in ../libexec/airtruth from it, in PREFIX/libexec/airtruth for libairtruth.so in PREFIX/lib, or
// where it was configured to be installed. Error: it is nowhere.
fs::path model_reader_program();

}  // namespace airtruth::aircraft
