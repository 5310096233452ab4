// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

// A shared library of ours that is loaded when it is first needed, and the places of such
// libraries, of programs and of data. The libraries that it depends on would otherwise be loaded at
// the start of every command (docs/optimisations.md).
namespace airtruth::lazy_library {

struct Library {
  const char* name;      // airtruth-late-opencv.so
  const char* variable;  // the environment variable that names another path
  const char* what;      // "the part with OpenCV's trackers", for messages
};

// The address of a symbol. The library is looked for in its places (places_of()), then as the
// dynamic linker does. It stays loaded to the end of the process. Throws Error where the library or
// the symbol is not there.
void* symbol_of(const Library& library, const std::string& symbol);

// The name under which a library of this build exports what it calls `symbol`. A library of another
// build, whose types may have other members, has another.
std::string of_build(const char* symbol);

// Where a child program or a lazy library of this name may be, in the order of preference: beside
// this program, in ../libexec/airtruth from it, in PREFIX/libexec/airtruth for a libairtruth.so in
// PREFIX/lib, or in the configured place of installation.
std::vector<std::filesystem::path> places_of(const char* name);

// The same for a file of data/, such as "network-detector/aircraft.onnx", with
// ../share/airtruth/data for ../libexec/airtruth.
std::vector<std::filesystem::path> data_places_of(const char* name);

}  // namespace airtruth::lazy_library
