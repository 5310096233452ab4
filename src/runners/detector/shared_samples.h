// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "foundation/base/unfinished.h"

namespace airtruth::detector {

// Memory that a program at this machine can map: a file in /dev/shm, or in the temporary folder
// where that does not exist. The destructor removes it.
class SharedSamples {
 public:
  // Throws Error where it cannot be made.
  explicit SharedSamples(std::size_t bytes);
  SharedSamples(const SharedSamples&) = delete;
  SharedSamples& operator=(const SharedSamples&) = delete;
  ~SharedSamples();

  const std::string& path() const { return path_; }
  char* data() { return static_cast<char*>(memory_); }

 private:
  std::string path_;
  std::size_t bytes_;
  std::optional<Unfinished> unfinished_;
  void* memory_ = nullptr;
};

}  // namespace airtruth::detector
