// SPDX-License-Identifier: Apache-2.0
#include "sequence/staging.h"

#include <cerrno>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "base/error.h"

namespace airtruth::sequence {
namespace {

// A folder that a finished run left, or an empty one: nothing else is ever replaced.
bool replaceable(const fs::path& folder) {
  return fs::is_directory(folder) && (fs::is_empty(folder) || fs::exists(folder / "sequence.json"));
}

void refuse_what_exists(const fs::path& folder, bool overwrite) {
  if (!fs::exists(fs::symlink_status(folder))) return;
  if (!overwrite) throw Error("exists already; give --overwrite to replace it", {folder.string()});
  if (!replaceable(folder))
    throw Error(
        "is not a folder that airtruth made (it holds no sequence.json); it is not replaced",
        {folder.string()});
}

// The uppermost folder of a path that is not there yet; empty where all are.
fs::path first_missing(fs::path folder) {
  fs::path missing;
  while (!folder.empty() && !fs::exists(folder)) {
    missing = folder;
    if (!folder.has_relative_path()) break;
    folder = folder.parent_path();
  }
  return missing;
}

// From `folder` up to `first`, as long as they are empty. Nothing where `first` is empty.
void remove_empty(fs::path folder, const fs::path& first) {
  std::error_code failed;
  while (!first.empty() && fs::remove(folder, failed) && folder != first)
    folder = folder.parent_path();
}

void clear(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) fs::remove_all(entry.path());
}

}  // namespace

StagedFolder::StagedFolder(fs::path final_folder, bool overwrite)
    : final_(std::move(final_folder)) {
  refuse_what_exists(final_, overwrite);
  const fs::path parent = final_.has_parent_path() ? final_.parent_path() : fs::path(".");
  part_ = parent / ("." + final_.filename().string() + ".part");
  std::error_code failed;
  first_made_ = first_missing(parent);
  fs::create_directories(parent, failed);
  if (!failed) fs::create_directory(part_, failed);
  if (failed)
    throw Error("cannot create the output folder: " + failed.message(), {parent.string()});
  lock_ = ::open(part_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0)
    throw Error(std::string("cannot open the output folder: ") + std::strerror(errno),
                {part_.string()});
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock_);
    throw Error("another run is writing this folder now", {final_.string()});
  }
  try {
    clear(part_);
  } catch (const fs::filesystem_error& error) {
    ::close(lock_);
    throw Error("cannot clear what an earlier run left: " + error.code().message(),
                {part_.string()});
  }
}

StagedFolder::~StagedFolder() {
  if (!committed_) {
    std::error_code ignored;
    fs::remove_all(part_, ignored);
    remove_empty(final_.parent_path(), first_made_);
  }
  ::close(lock_);
}

void StagedFolder::commit() {
  std::error_code failed;
  fs::path old;
  if (fs::exists(final_)) {
    old = part_;
    old += ".old";
    fs::remove_all(old, failed);
    fs::rename(final_, old, failed);
    if (failed) throw Error("cannot replace: " + failed.message(), {final_.string()});
  }
  fs::rename(part_, final_, failed);
  if (failed) {
    if (!old.empty()) {
      std::error_code ignored;
      fs::rename(old, final_, ignored);
    }
    throw Error("cannot create: " + failed.message(), {final_.string()});
  }
  committed_ = true;
  if (!old.empty()) fs::remove_all(old, failed);
}

}  // namespace airtruth::sequence
