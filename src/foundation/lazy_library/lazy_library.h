// SPDX-License-Identifier: Apache-2.0
#pragma once

// A shared library of ours that is loaded when it is first needed. The libraries that it depends on
// would otherwise be loaded at the start of every command (docs/optimisations.md).
namespace airtruth::lazy_library {

struct Library {
  const char* name;      // airtruth-late-opencv.so
  const char* variable;  // the environment variable that names another path
  const char* what;      // "the part with OpenCV's trackers", for messages
};

// The address of a symbol. The library is looked for in its places (places.h),
// then as the dynamic linker does. It stays loaded to the end of the process. Throws Error where
// the library or the symbol is not there.
void* symbol_of(const Library& library, const char* symbol);

}  // namespace airtruth::lazy_library
