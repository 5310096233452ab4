// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "foundation/base/descriptor.h"
#include "foundation/base/files.h"
#include "foundation/base/log.h"
#include "foundation/base/unfinished.h"

namespace airtruth::pipeline {

// A folder that appears whole or not at all. Files are written to a hidden folder beside it
// (".NAME.part"), which commit() renames to the final name. Destruction before commit() removes the
// hidden folder and leaves the previous contents untouched. Of two runs over one folder, the second
// is refused at once; where the file system has no locks that is not seen, and said. The kernel
// releases the lock when a process ends, so the next run can remove
// the files of a killed run.
class StagedFolder {
 public:
  // Throws Error where `final` exists and overwrite is false, is a folder that this program did not
  // make, or cannot be written.
  StagedFolder(fs::path final_folder, bool overwrite, const Warn& to = {});
  StagedFolder(const StagedFolder&) = delete;
  StagedFolder& operator=(const StagedFolder&) = delete;
  ~StagedFolder();

  const fs::path& path() const { return part_; }
  void commit();

 private:
  void remove_part() const;
  void move_into_place();
  void recover() const;

  fs::path final_;
  fs::path part_;
  // The previous folder, until it is removed.
  fs::path old_;
  Descriptor lock_;
  bool committed_ = false;
  // The uppermost of the parent folders that were created; empty: none.
  fs::path first_made_;
  std::optional<Unfinished> unfinished_;
};

}  // namespace airtruth::pipeline
