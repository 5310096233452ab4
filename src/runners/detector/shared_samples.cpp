// SPDX-License-Identifier: Apache-2.0
#include "runners/detector/shared_samples.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "foundation/base/error.h"

namespace airtruth::detector {

SharedSamples::SharedSamples(std::size_t bytes) : bytes_(bytes) {
  namespace fs = std::filesystem;
  std::error_code unknown;
  const fs::path shared = "/dev/shm";
  path_ = ((fs::is_directory(shared, unknown) ? shared : fs::temp_directory_path()) /
           "airtruth-detect-XXXXXX")
              .string();
  const int file = ::mkostemp(path_.data(), O_CLOEXEC);
  if (file < 0)
    throw Error(
        std::string("cannot create memory for a detector's frames: ") + std::strerror(errno),
        {path_});
  unfinished_.emplace(Unfinished::path(path_));
  // The blocks are taken now: a full disk is an error here, and no signal later.
  const int failed = ::posix_fallocate(file, 0, static_cast<off_t>(bytes));
  memory_ = failed == 0 ? ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0)
                        : MAP_FAILED;
  const int fault = failed != 0 ? failed : errno;
  ::close(file);
  if (memory_ == MAP_FAILED) {
    ::unlink(path_.c_str());
    throw Error(std::string("cannot take memory for a detector's frames: ") + std::strerror(fault),
                {path_});
  }
}

SharedSamples::~SharedSamples() {
  ::munmap(memory_, bytes_);
  ::unlink(path_.c_str());
}

}  // namespace airtruth::detector
