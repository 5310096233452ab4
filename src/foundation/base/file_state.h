// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <stop_token>

// The state of files: who works on one, whether its content is still the same, and whether an
// output may be written.
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

// Checks of an output path before the work begins, so that hours of work do not end with an error
// about a file name.
//
// check_output_file() throws Error where write_file() would fail for a reason that exists already:
// the path exists and may not be replaced, is a folder, or lies in a folder that is missing or not
// writable. An empty path means that there is no output, and passes.
void check_output_file(const std::filesystem::path& path, bool overwrite);

// The same for a folder that is created, with its parents, where it is missing. Throws Error where
// the path is a file, or where the nearest existing folder is not writable.
void check_output_folder(const std::filesystem::path& path);

}  // namespace airtruth
