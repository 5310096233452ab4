// SPDX-License-Identifier: Apache-2.0
#include "foundation/lazy_library/places.h"

#include <dlfcn.h>

#include "foundation/base/files.h"

namespace airtruth::lazy_library {
namespace {

// The place where a shared library holds this code, in PREFIX/lib or, as on Debian, in
// PREFIX/lib/x86_64-linux-gnu. It is empty in a program, whose name need not be a path.
std::vector<fs::path> beside_library(const char* name) {
  Dl_info info{};
  if (::dladdr(reinterpret_cast<const void*>(&places_of), &info) == 0) return {};
  const fs::path library = info.dli_fname;
  if (!library.is_absolute()) return {};
  const fs::path folder = library.parent_path().lexically_normal();
  const fs::path place = fs::path("libexec") / "airtruth" / name;
  return {folder.parent_path() / place, folder.parent_path().parent_path() / place};
}

}  // namespace

std::vector<fs::path> places_of(const char* name) {
  std::error_code ignored;
  const fs::path own = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  std::vector<fs::path> places = beside_library(name);
  places.insert(places.begin(), {own / name, own.parent_path() / "libexec" / "airtruth" / name});
  places.push_back(fs::path(AIRTRUTH_LIBEXEC_FOLDER) / name);
  return places;
}

}  // namespace airtruth::lazy_library
