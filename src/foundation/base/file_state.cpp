// SPDX-License-Identifier: Apache-2.0
#include "foundation/base/file_state.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"

namespace airtruth {

Lock try_lock(int file, const std::filesystem::path& path, Sharing sharing) {
  const int how = sharing == Sharing::kShared ? LOCK_SH : LOCK_EX;
  while (::flock(file, how | LOCK_NB) != 0) {
    if (errno == EINTR) continue;
    if (errno == EWOULDBLOCK) return Lock::kBusy;
    if (errno == ENOLCK || errno == EOPNOTSUPP || errno == ENOSYS || errno == EINVAL)
      return Lock::kUnsupported;
    throw Error(std::string("cannot lock: ") + std::strerror(errno), {path.string()});
  }
  return Lock::kTaken;
}

bool is_open_as(int file, const std::filesystem::path& name) {
  struct stat opened {};
  struct stat named {};
  return ::fstat(file, &opened) == 0 && ::lstat(name.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

std::optional<LockedPlace> make_locked_place(PlaceKind kind,
                                             const std::filesystem::path& folder,
                                             std::string_view begins) {
  for (;;) {
    std::string name = (folder / std::string(begins).append("XXXXXX")).string();
    Descriptor file;
    if (kind == PlaceKind::kFile)
      file.reset(::mkostemp(name.data(), O_CLOEXEC));
    else if (::mkdtemp(name.data()) != nullptr)
      file.reset(::open(name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    else
      return std::nullopt;
    // A run that clears away may take the new place for a dead one's before it is locked.
    if (!file.is_open() && (kind == PlaceKind::kFile || errno != ENOENT)) return std::nullopt;
    if (file.is_open() && try_lock(file.get(), name) != Lock::kBusy && is_open_as(file.get(), name))
      return LockedPlace{name, std::move(file)};
  }
}

void remove_dead_places(const std::filesystem::path& folder, std::string_view begins) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    if (!entry.path().filename().string().starts_with(begins)) continue;
    const Descriptor file(
        ::open(entry.path().c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    if (file.is_open() && try_lock(file.get(), entry.path()) == Lock::kTaken)
      fs::remove_all(entry.path(), ignored);
  }
}

void warn_of_no_locks(const std::filesystem::path& path, const Warn& to) {
  static std::atomic<bool> is_said{false};
  if (!is_said.exchange(true))
    warn(to,
         path.string() +
             ": the file system has no locks; two runs that write one folder at the same time are "
             "not kept apart");
}

RunLock::RunLock(const std::filesystem::path& locked,
                 const std::filesystem::path& folder,
                 const Warn& to,
                 Sharing sharing,
                 const char* busy) {
  const bool is_folder = fs::is_directory(locked);
  file_.reset(::open(
      locked.c_str(), is_folder ? O_RDONLY | O_CLOEXEC : O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (!file_.is_open())
    throw Error(std::string(is_folder ? "cannot open: " : "cannot create: ") + std::strerror(errno),
                {locked.string()});
  const Lock lock = try_lock(file_.get(), locked, sharing);
  if (lock == Lock::kBusy) throw Error(busy, {folder.string()});
  if (lock == Lock::kUnsupported) warn_of_no_locks(folder, to);
}

WaitingLock::WaitingLock(const std::filesystem::path& file, const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kBetweenTries(100);
  std::error_code ignored;
  std::filesystem::create_directories(file.parent_path(), ignored);
  file_.reset(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (!file_.is_open())
    throw Error(std::string("cannot create: ") + std::strerror(errno), {file.string()});
  while (try_lock(file_.get(), file) == Lock::kBusy) {
    if (stop.stop_requested()) throw Interrupted();
    std::this_thread::sleep_for(kBetweenTries);
  }
}

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

void check_output_file(const fs::path& path,
                       bool overwrite,
                       std::initializer_list<const char*> endings) {
  if (path.empty()) return;
  refuse_existing(path, overwrite);
  if (fs::is_directory(path)) throw Error("is a folder; expected a file to write", {path.string()});
  const std::string ending = path.extension().string();
  if (endings.size() > 0 &&
      std::find(endings.begin(), endings.end(), lower_case(ending)) == endings.end())
    throw Error(fmt::format("has {}; expected {}",
                            ending.empty() ? "no ending" : "the ending " + ending,
                            fmt::join(endings, " or ")),
                {path.string()});
  const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(parent))
    throw Error("cannot be written: there is no folder " + parent.string(), {path.string()});
  if (::access(parent.c_str(), W_OK | X_OK) != 0)
    throw Error(std::string("cannot be written: ") + std::strerror(errno), {path.string()});
}

void check_output_folder(const fs::path& path) {
  fs::path nearest = absolute_path(path);
  while (!fs::exists(fs::symlink_status(nearest)) && nearest.has_relative_path())
    nearest = nearest.parent_path();
  if (!fs::is_directory(nearest))
    throw Error("cannot be made: " + nearest.string() + " is no folder", {path.string()});
  if (::access(nearest.c_str(), W_OK | X_OK) != 0)
    throw Error(std::string("cannot be written: ") + std::strerror(errno), {path.string()});
}

}  // namespace airtruth
