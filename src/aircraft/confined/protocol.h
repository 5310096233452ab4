// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "aircraft/model/load_options.h"
#include "aircraft/model/raw_model.h"
#include "foundation/sandbox/messages.h"

// The protocol between the program and airtruth-model-reader over one socket. A message has a kind,
// a length and bytes. The reader requests each file by name and receives its bytes; it never opens
// a file.
namespace airtruth::confined {

using sandbox::bytes_of;
using sandbox::Channel;
using sandbox::error_from_bytes;
using sandbox::WireReader;
using sandbox::WireWriter;

enum class Message : std::uint8_t {
  kJob = 1,  // to the reader: bytes_of(ReaderJob)
  kAskKind,  // from the reader: a path; the answer is kKind
  kAskFile,  // from the reader: a limit in bytes and a path; the answer is kFile or kError
  kKind,     // to the reader: one byte, ModelFiles::Kind
  kFile,     // to the reader: the file's bytes
  kModel,    // from the reader, last: bytes_of(RawModel)
  kError,    // an Error: of the model (from the reader, last), or of a file (to the reader)
};

struct ReaderJob {
  std::string file;          // below the folder
  std::string shown_folder;  // for messages
  std::string in_data_root;  // ModelFiles::in_data_root
  model::LoadOptions options;
};

std::string bytes_of(const ReaderJob& job);
ReaderJob job_from_bytes(std::string_view bytes);

// A RawModel as bytes, for the socket and for the cache.
std::string bytes_of(const model::RawModel& model);

// Throws Error where the bytes are not exactly one model that passes check_model.
model::RawModel model_from_bytes(std::string_view bytes);

}  // namespace airtruth::confined
