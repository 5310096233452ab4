// SPDX-License-Identifier: Apache-2.0
#include "foundation/base/file_stamp.h"

#include <sys/stat.h>

namespace airtruth {
namespace {

std::int64_t nanoseconds(const timespec& time) {
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

}  // namespace

FileStamp file_stamp(const std::filesystem::path& file) {
  struct stat facts {};
  if (::stat(file.c_str(), &facts) != 0) return {};
  return {static_cast<std::uint64_t>(facts.st_dev),
          static_cast<std::uint64_t>(facts.st_ino),
          static_cast<std::int64_t>(facts.st_size),
          nanoseconds(facts.st_ctim),
          nanoseconds(facts.st_mtim)};
}

}  // namespace airtruth
