// SPDX-License-Identifier: Apache-2.0
#include "foundation/lazy_library/lazy_library.h"

#include <cstdlib>
#include <filesystem>
#include <string>

#include <dlfcn.h>

#include "foundation/base/error.h"
#include "foundation/lazy_library/places.h"

namespace airtruth::lazy_library {
namespace {

// A program in the build folder knows the place of its lazy libraries as the dynamic linker does.
std::string path_of(const Library& library) {
  if (const char* stated = std::getenv(library.variable); stated != nullptr && *stated != '\0')
    return stated;
  std::error_code ignored;
  for (const std::filesystem::path& place : places_of(library.name))
    if (std::filesystem::is_regular_file(place, ignored)) return place.string();
  return library.name;
}

[[noreturn]] void fail(const Library& library) {
  const char* reason = ::dlerror();
  throw Error(std::string(library.name) + ", " + library.what + ", cannot be loaded (" +
              (reason != nullptr ? reason : "no reason is known") +
              "); install airtruth whole, or set " + library.variable + " to it");
}

}  // namespace

void* symbol_of(const Library& library, const char* symbol) {
  void* loaded = ::dlopen(path_of(library).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (loaded == nullptr) fail(library);
  void* address = ::dlsym(loaded, symbol);
  if (address == nullptr) fail(library);
  return address;
}

}  // namespace airtruth::lazy_library
