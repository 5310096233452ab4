// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace airtruth::lazy_library {

// Where a child program or a lazy library of this name may be, in the order of preference: beside
// this program, in ../libexec/airtruth from it, in PREFIX/libexec/airtruth for a libairtruth.so in
// PREFIX/lib, or in the configured place of installation.
std::vector<std::filesystem::path> places_of(const char* name);

// The same for a file of data/, such as "network-detector/aircraft.onnx", with
// ../share/airtruth/data for ../libexec/airtruth.
std::vector<std::filesystem::path> data_places_of(const char* name);

}  // namespace airtruth::lazy_library
