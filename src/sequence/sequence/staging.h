// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "foundation/base/unfinished.h"

namespace airtruth::sequence {

namespace fs = std::filesystem;

// A folder that appears whole or not at all: files go into a hidden folder beside it
// (".NAME.part"), and commit() renames that into place. Destroyed before commit(), it leaves
// nothing, and what was there before is untouched. Two runs over one folder: the second is refused
// at once (a lock that the kernel drops when a process dies, so that what a killed run left is
// simply cleared away).
class StagedFolder {
 public:
  // Error where `final` exists and overwrite is false, is no folder of ours to replace, or cannot
  // be written.
  StagedFolder(fs::path final_folder, bool overwrite);
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
  fs::path old_;  // what is replaced, until it is removed
  int lock_ = -1;
  bool committed_ = false;
  fs::path first_made_;  // the uppermost of the folders that were made for it; empty: none
  std::optional<Unfinished> unfinished_;
};

}  // namespace airtruth::sequence
