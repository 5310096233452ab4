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

std::optional<LockedPlace> place_in(const fs::path& folder, PlaceKind kind) {
  // Other users' places cannot be opened, or not removed.
  remove_dead_places(folder, kBegins);
  return make_locked_place(kind, folder, kBegins);
}

}  // namespace

MemoryPlace::MemoryPlace(PlaceKind kind, const char* what_for, const fs::path& memory) {
  auto made = place_in(memory, kind);
  const fs::path folder = made ? memory : fs::temp_directory_path();
  if (!made) made = place_in(folder, kind);
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
