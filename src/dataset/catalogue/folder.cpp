// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/folder.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "foundation/base/files.h"

namespace airtruth::dataset {

Folder open_folder(const Catalogue& catalogue, const fs::path& root, std::int64_t max_in_a_folder) {
  Folder folder{root};
  std::error_code failed;
  fs::create_directories(folder.sequences(), failed);
  if (failed) throw Error("cannot create: " + failed.message(), {root.string()});
  if (!fs::exists(folder.catalogue())) {
    // The catalogue is written last: with it, the layout is fixed.
    folder.layout = layout_for(Expansion(catalogue).size(), max_in_a_folder);
    write_layout(folder.sequences(), folder.layout);
    write_file(folder.catalogue(), catalogue.text);
  } else if (read_file(folder.catalogue()) != catalogue.text) {
    throw Error("was begun with another catalogue (its catalogue.toml differs from " +
                    catalogue.file.string() + "); expected a new folder, or that catalogue",
                {root.string()});
  }
  return folder;
}

FolderLock::FolderLock(const Folder& folder, bool shared) {
  const fs::path name = folder.root / ".lock";
  file_ = ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (file_ < 0)
    throw Error(std::string("cannot create: ") + std::strerror(errno), {name.string()});
  if (::flock(file_, (shared ? LOCK_SH : LOCK_EX) | LOCK_NB) == 0) return;
  ::close(file_);
  throw Error("another build is at work in this folder", {folder.root.string()});
}

FolderLock::~FolderLock() { ::close(file_); }

}  // namespace airtruth::dataset
