// SPDX-License-Identifier: Apache-2.0
#include "sequence/pipeline/staged_folder.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

#include <fcntl.h>

#include "foundation/base/error.h"
#include "foundation/base/file_state.h"

namespace airtruth::pipeline {
namespace {

// Only a folder that a finished run made, or an empty one, may be replaced.
bool replaceable(const fs::path& folder) {
  return fs::is_directory(folder) &&
         (fs::is_empty(folder) || fs::exists(folder / "sequence.json") ||
          fs::exists(folder / "comparison.json"));
}

void refuse_what_exists(const fs::path& folder, bool overwrite) {
  if (!fs::exists(fs::symlink_status(folder))) return;
  if (!overwrite) throw Error("exists already; give --overwrite to replace it", {folder.string()});
  if (!replaceable(folder))
    throw Error(
        "is not a folder that airtruth made (it holds no sequence.json); it is not replaced",
        {folder.string()});
}

void clear(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) fs::remove_all(entry.path());
}

}  // namespace

StagedFolder::StagedFolder(fs::path final_folder, bool overwrite, const Warn& to)
    : final_(std::move(final_folder)) {
  const fs::path parent = final_.has_parent_path() ? final_.parent_path() : fs::path(".");
  part_ = parent / ("." + final_.filename().string() + ".part");
  old_ = part_;
  old_ += ".old";
  refuse_what_exists(final_, overwrite);
  std::error_code failed;
  first_made_ = first_missing(parent);
  fs::create_directories(parent, failed);
  if (!failed) fs::create_directory(part_, failed);
  if (failed)
    throw Error("cannot create the output folder: " + failed.message(), {parent.string()});
  lock_.reset(::open(part_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (!lock_.is_open())
    throw Error(std::string("cannot open the output folder: ") + std::strerror(errno),
                {part_.string()});
  const Lock lock = try_lock(lock_.get(), part_);
  if (lock == Lock::kBusy) throw Error("another run is writing this folder now", {final_.string()});
  if (lock == Lock::kUnsupported) warn_of_no_locks(final_, to);
  try {
    clear(part_);
    recover();
    refuse_what_exists(final_, overwrite);
  } catch (const fs::filesystem_error& error) {
    throw Error("cannot clear what an earlier run left: " + error.code().message(),
                {part_.string()});
  } catch (const Error&) {
    fs::remove(part_, failed);
    throw;
  }
  unfinished_.emplace([this] { remove_part(); });
}

StagedFolder::~StagedFolder() {
  unfinished_.reset();
  if (!committed_) remove_part();
}

void StagedFolder::remove_part() const {
  std::error_code ignored;
  fs::remove_all(part_, ignored);
  remove_empty(final_.parent_path(), first_made_);
}

void StagedFolder::commit() {
  std::error_code ignored;
  const Unfinished removing = Unfinished::path(old_);
  unfinished_->finish([this] { move_into_place(); });
  committed_ = true;
  fs::remove_all(old_, ignored);
}

// Swapped in one step where the file system can, so that a kill at any instant leaves either what
// was there or what is new.
void StagedFolder::move_into_place() {
  std::error_code failed;
  const bool replaces = fs::exists(final_);
  if (replaces &&
      ::renameat2(AT_FDCWD, part_.c_str(), AT_FDCWD, final_.c_str(), RENAME_EXCHANGE) == 0) {
    fs::rename(part_, old_, failed);
    return;
  }
  if (replaces) fs::rename(final_, old_, failed);
  if (failed) throw Error("cannot replace: " + failed.message(), {final_.string()});
  fs::rename(part_, final_, failed);
  if (!failed) return;
  std::error_code ignored;
  if (replaces) fs::rename(old_, final_, ignored);
  throw Error("cannot create: " + failed.message(), {final_.string()});
}

// A run that was killed while it replaced a folder left the old one beside it.
void StagedFolder::recover() const {
  std::error_code ignored;
  if (!fs::exists(fs::symlink_status(old_))) return;
  if (fs::exists(fs::symlink_status(final_)))
    fs::remove_all(old_, ignored);
  else
    fs::rename(old_, final_, ignored);
}

}  // namespace airtruth::pipeline
