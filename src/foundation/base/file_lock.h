// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stop_token>

namespace airtruth {

// An advisory lock (flock) on a file, made where it is missing with the folders above it. Held
// while one thread or process makes what others would make as well; the others wait. The kernel
// drops it when the process dies. Error where the file cannot be made; Interrupted on stop.
class WaitingLock {
 public:
  WaitingLock(const std::filesystem::path& file, const std::stop_token& stop);
  WaitingLock(const WaitingLock&) = delete;
  WaitingLock& operator=(const WaitingLock&) = delete;
  ~WaitingLock();

 private:
  int file_ = -1;
};

}  // namespace airtruth
