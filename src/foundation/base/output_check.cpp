// SPDX-License-Identifier: Apache-2.0
#include "foundation/base/output_check.h"

#include <cerrno>
#include <cstring>

#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth {

void check_output_file(const fs::path& path, bool overwrite) {
  if (path.empty()) return;
  refuse_existing(path, overwrite);
  if (fs::is_directory(path)) throw Error("is a folder; expected a file to write", {path.string()});
  const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(parent))
    throw Error("cannot be written: there is no folder " + parent.string(), {path.string()});
  if (::access(parent.c_str(), W_OK | X_OK) != 0)
    throw Error(std::string("cannot be written: ") + std::strerror(errno), {path.string()});
}

void check_output_folder(const fs::path& path) {
  fs::path nearest = fs::absolute(path).lexically_normal();
  while (!fs::exists(fs::symlink_status(nearest)) && nearest.has_relative_path())
    nearest = nearest.parent_path();
  if (!fs::is_directory(nearest))
    throw Error("cannot be made: " + nearest.string() + " is no folder", {path.string()});
  if (::access(nearest.c_str(), W_OK | X_OK) != 0)
    throw Error(std::string("cannot be written: ") + std::strerror(errno), {path.string()});
}

}  // namespace airtruth
