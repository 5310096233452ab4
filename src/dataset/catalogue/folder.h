// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include "dataset/catalogue/catalogue.h"
#include "dataset/catalogue/expand.h"
#include "dataset/sequences/layout.h"
#include "foundation/base/file_state.h"
#include "foundation/base/log.h"

namespace airtruth::catalogue {

// The paths within a data set's folder.
struct Folder {
  // Reads the layout of a set that was begun. Throws Error as read_layout does.
  explicit Folder(fs::path at) : root(std::move(at)), layout(sequences::read_layout(sequences())) {}

  fs::path root;
  sequences::Layout layout;

  fs::path catalogue() const { return root / "catalogue.toml"; }
  fs::path backgrounds() const { return root / "backgrounds"; }
  fs::path sequences() const { return root / "sequences"; }
  // The one place that decides where a sequence lies.
  fs::path sequence(const Item& item) const {
    return sequences() / layout.folder_of(item.index) / item.name;
  }
  fs::path cache() const { return root / ".cache"; }
  fs::path manifest() const { return root / "manifest"; }
  fs::path record() const { return root / "dataset.json"; }
  fs::path lock() const { return root / ".lock"; }
  // The list of failures of a whole build, or of one share of it.
  fs::path failed(std::int64_t share, std::int64_t shares) const {
    return root / (shares > 1 ? "failed-" + std::to_string(share) + ".jsonl" : "failed.jsonl");
  }
  // True where the sequence exists. Its folder is renamed into place with its record inside, so the
  // record proves that it is whole.
  bool holds(const Item& item) const { return fs::exists(sequence(item) / "sequence.json"); }
};

// Creates the folder, or opens one that was begun with the same catalogue; that one keeps its
// layout whatever `max_in_a_folder` is. Throws Error where it holds the set of another catalogue.
Folder open_folder(const Catalogue& catalogue,
                   const fs::path& root,
                   std::int64_t max_in_a_folder = sequences::kMaxSequencesInAFolder);

// The catalogue of a set that was begun. Throws Error for any other folder.
Catalogue catalogue_of(const Folder& folder);

// A lock that is held during a build; the kernel releases it when the process ends. Workers that
// each make their own share hold it together (`shared`); a whole build holds it alone.
// Throws Error where another process holds it. Where the file system has no locks that is not seen,
// and said.
RunLock lock_of(const Folder& folder, Sharing sharing, const Warn& to = {});

}  // namespace airtruth::catalogue
