// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <stop_token>
#include <string_view>

#include "foundation/base/descriptor.h"
#include "foundation/base/log.h"

// The state of files: who works on one, whether its content is still the same, and whether an
// output may be written.
namespace airtruth {

// What flock() answers at once. kUnsupported: the file system has no locks (Lustre and NFS by how
// they are mounted, some of FUSE), so nothing is known about others.
enum class Lock { kTaken, kBusy, kUnsupported };
enum class Sharing { kAlone, kShared };
// Throws Error with the name `path` for every other answer.
Lock try_lock(int file, const std::filesystem::path& path, Sharing sharing = Sharing::kAlone);

// True where the descriptor is of what has this name now.
bool is_open_as(int file, const std::filesystem::path& name);

// A file or folder of this run alone, under a name of its own that begins with `begins`. The lock
// on its descriptor tells others that the run lives.
struct LockedPlace {
  std::filesystem::path path;
  Descriptor descriptor;
};
enum class PlaceKind { kFile, kFolder };
// Empty, with errno, where it cannot be made.
std::optional<LockedPlace> make_locked_place(PlaceKind kind,
                                             const std::filesystem::path& folder,
                                             std::string_view begins);
// Removes what runs that were killed left in a folder under such names: nobody holds its lock.
void remove_dead_places(const std::filesystem::path& folder, std::string_view begins);

// Says once a process that files are not locked.
void warn_of_no_locks(const std::filesystem::path& path, const Warn& to);

// Keeps a second run away from a folder that a run goes on in, until it is destroyed; the kernel
// releases the lock when the process dies. `locked` is a folder that exists, which is locked
// itself, or a file, which is made where it is missing. Throws Error with the words `busy` and the
// name `folder` where another process holds it; where the file system has no
// locks the run goes on, with a warning.
class RunLock {
 public:
  RunLock(const std::filesystem::path& locked,
          const std::filesystem::path& folder,
          const Warn& to,
          Sharing sharing = Sharing::kAlone,
          const char* busy = "another run is writing this folder now");

 private:
  Descriptor file_;
};

// An advisory lock (flock) on a file, for work that only one thread or process should do at a time,
// for example filling a cache. The constructor creates the file and its folders where they are
// missing and waits, checking ten times a second, until the lock is free, or goes on without one
// where the file system has no locks: the work is done more than once then. The destructor releases
// the lock, and the kernel releases it when the process dies; the empty file stays. The constructor
// throws Error where the file cannot be created, and Interrupted where `stop` is requested while it
// waits.
//
//   const WaitingLock lock(folder / "b737.lock", stop);
//   if (!exists(result)) make(result);  // one process makes it, the others find it
class WaitingLock {
 public:
  WaitingLock(const std::filesystem::path& file, const std::stop_token& stop);

 private:
  Descriptor file_;
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
// writable; or where its name has none of `endings` (".toml"), if there are any. An empty path
// means that there is no output, and passes.
void check_output_file(const std::filesystem::path& path,
                       bool overwrite,
                       std::initializer_list<const char*> endings = {});

// The same for a folder that is created, with its parents, where it is missing. Throws Error where
// the path is a file, or where the nearest existing folder is not writable.
void check_output_folder(const std::filesystem::path& path);

}  // namespace airtruth
