// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stop_token>

namespace airtruth {

// An advisory lock (flock) on a file, for work that only one thread or process should do at a time,
// for example filling a cache. The constructor creates the file and its folders where they are
// missing and waits, checking ten times a second, until the lock is free. The destructor releases
// the lock, and the kernel releases it when the process dies; the empty file stays. The constructor
// throws Error where the file cannot be created or locked, and Interrupted where `stop` is
// requested while it waits.
//
//   const WaitingLock lock(folder / "b737.lock", stop);
//   if (!exists(result)) make(result);  // one process makes it, the others find it
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
