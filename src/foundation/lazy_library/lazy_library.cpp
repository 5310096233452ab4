// SPDX-License-Identifier: Apache-2.0
#include "foundation/lazy_library/lazy_library.h"

#include <cstdlib>
#include <string>

#include <dlfcn.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth::lazy_library {
namespace {

// The places where a shared library holds this code, in PREFIX/lib or, as on Debian, in
// PREFIX/lib/x86_64-linux-gnu. There are none in a program, whose name need not be a path.
std::vector<fs::path> beside_library(const fs::path& below_prefix) {
  Dl_info info{};
  if (::dladdr(reinterpret_cast<const void*>(&places_of), &info) == 0) return {};
  const fs::path library = info.dli_fname;
  if (!library.is_absolute()) return {};
  const fs::path folder = library.parent_path().lexically_normal();
  return {folder.parent_path() / below_prefix, folder.parent_path().parent_path() / below_prefix};
}

std::vector<fs::path> places_below(const fs::path& in_prefix,
                                   const fs::path& installed,
                                   const char* name) {
  std::error_code ignored;
  const fs::path own = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  std::vector<fs::path> places = beside_library(in_prefix / name);
  places.insert(places.begin(), {own / name, own.parent_path() / in_prefix / name});
  places.push_back(installed / name);
  return places;
}

// A program in the build folder knows the place of its lazy libraries as the dynamic linker does.
std::string path_of(const Library& library) {
  if (const char* stated = std::getenv(library.variable); stated != nullptr && *stated != '\0')
    return stated;
  std::error_code ignored;
  for (const fs::path& place : places_of(library.name))
    if (fs::is_regular_file(place, ignored)) return place.string();
  return library.name;
}

[[noreturn]] void fail(const Library& library) {
  const char* reason = ::dlerror();
  throw Error(std::string(library.name) + ", " + library.what + ", cannot be loaded (" +
              (reason != nullptr ? reason : "no reason is known") +
              "); install airtruth whole, or set " + library.variable + " to it");
}

}  // namespace

std::vector<fs::path> places_of(const char* name) {
  return places_below("libexec/airtruth", AIRTRUTH_LIBEXEC_FOLDER, name);
}

std::vector<fs::path> data_places_of(const char* name) {
  return places_below("share/airtruth/data", AIRTRUTH_DATA_FOLDER, name);
}

std::string of_build(const char* symbol) { return std::string(symbol) + "_" AIRTRUTH_BUILD; }

void* symbol_of(const Library& library, const std::string& symbol) {
  void* loaded = ::dlopen(path_of(library).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (loaded == nullptr) fail(library);
  void* address = ::dlsym(loaded, symbol.c_str());
  if (address == nullptr) fail(library);
  return address;
}

}  // namespace airtruth::lazy_library
