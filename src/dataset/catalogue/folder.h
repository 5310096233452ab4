// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "dataset/catalogue/catalogue.h"

namespace airtruth::dataset {

// The places of a data set.
struct Folder {
  fs::path root;

  fs::path catalogue() const { return root / "catalogue.toml"; }
  fs::path backgrounds() const { return root / "backgrounds"; }
  fs::path sequences() const { return root / "sequences"; }
  fs::path sequence(const std::string& name) const { return sequences() / name; }
  fs::path cache() const { return root / ".cache"; }
  fs::path manifest() const { return root / "manifest"; }
  fs::path record() const { return root / "dataset.json"; }
  // Of a whole build, or of one share of it.
  fs::path failed(std::int64_t share, std::int64_t shares) const {
    return root / (shares > 1 ? "failed-" + std::to_string(share) + ".jsonl" : "failed.jsonl");
  }
  // Is the sequence there? Its folder is renamed into place with its record inside, so the record
  // is enough.
  bool holds(const std::string& name) const { return fs::exists(sequence(name) / "sequence.json"); }
};

// Creates the folder, or opens one that was begun with the same catalogue; Error where it holds
// another's.
Folder open_folder(const Catalogue& catalogue, const fs::path& root);

// Held while a build is at work; dropped by the kernel when the process dies. Shared among workers
// that each make their own share; a whole build is alone.
class FolderLock {
 public:
  FolderLock(const Folder& folder, bool shared);  // Error where another holds it
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

 private:
  int file_ = -1;
};

}  // namespace airtruth::dataset
