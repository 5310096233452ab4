// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "foundation/base/descriptor.h"
#include "foundation/base/file_state.h"
#include "foundation/base/unfinished.h"

namespace airtruth {

// A file or folder in memory for another process: in /dev/shm, so that nothing is written to a
// disk, or in the temporary folder where it cannot be made there. The destructor removes it. A lock
// on it tells that its run lives: the constructor removes those of runs that were killed.
class MemoryPlace {
 public:
  // Throws Error, which says what it is for, where it cannot be made.
  MemoryPlace(PlaceKind kind,
              const char* what_for,
              const std::filesystem::path& memory = "/dev/shm");
  MemoryPlace(const MemoryPlace&) = delete;
  MemoryPlace& operator=(const MemoryPlace&) = delete;
  ~MemoryPlace();

  const std::filesystem::path& path() const { return path_; }
  // Of a file: open to read and write.
  int descriptor() const { return descriptor_.get(); }

 private:
  std::filesystem::path path_;
  Descriptor descriptor_;
  std::optional<Unfinished> unfinished_;
};

}  // namespace airtruth
