// SPDX-License-Identifier: Apache-2.0
#include "foundation/run_files/memory_place.h"

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth {
namespace {

constexpr const char* kBegins = "airtruth-run-";

fs::path memory_folder() {
  std::error_code unknown;
  const fs::path shared = "/dev/shm";
  return fs::is_directory(shared, unknown) ? shared : fs::temp_directory_path();
}

}  // namespace

MemoryPlace::MemoryPlace(PlaceKind kind, const char* what_for) {
  const fs::path folder = memory_folder();
  // Other users' places cannot be opened, or not removed.
  remove_dead_places(folder, kBegins);
  auto made = make_locked_place(kind, folder, kBegins);
  if (!made)
    throw Error(std::string("cannot create memory for ") + what_for + ": " + std::strerror(errno),
                {folder.string()});
  path_ = made->path;
  descriptor_ = std::move(made->descriptor);
  unfinished_.emplace(Unfinished::path(path_));
}

MemoryPlace::~MemoryPlace() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace airtruth
