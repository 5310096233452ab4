// SPDX-License-Identifier: Apache-2.0
#include "foundation/base/file_lock.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "foundation/base/error.h"

namespace airtruth {

WaitingLock::WaitingLock(const std::filesystem::path& file, const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kBetweenTries(100);
  std::error_code ignored;
  std::filesystem::create_directories(file.parent_path(), ignored);
  file_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (file_ < 0)
    throw Error(std::string("cannot create: ") + std::strerror(errno), {file.string()});
  while (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK && errno != EINTR) {
      const std::string why = std::strerror(errno);
      ::close(file_);
      throw Error("cannot lock: " + why, {file.string()});
    }
    if (stop.stop_requested()) {
      ::close(file_);
      throw Interrupted();
    }
    std::this_thread::sleep_for(kBetweenTries);
  }
}

WaitingLock::~WaitingLock() { ::close(file_); }

}  // namespace airtruth
