// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

namespace airtruth {

// Identifies a file and its content at one time: a file that is written or replaced has another
// stamp. (Its time of change, which programs cannot set, counts in steps of the kernel's clock: a
// file that is written twice within some milliseconds at the same size may keep its stamp.)
struct FileStamp {
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::int64_t bytes = -1;  // -1: there is no file
  std::int64_t changed_ns = 0;
  std::int64_t modified_ns = 0;
  bool operator==(const FileStamp&) const = default;
};
FileStamp file_stamp(const std::filesystem::path& file);

}  // namespace airtruth
