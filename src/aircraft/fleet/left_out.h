// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>

// Names of Debian's catalogue that cannot be drawn, or are no aircraft
// (data/aircraft-left-out/README.md). They are not offered.
namespace airtruth::aircraft {

// data/aircraft-left-out/left-out.csv, put into the program when it is built.
std::string_view left_out_table();

// The reason of each, by its name.
const std::map<std::string, std::string>& left_out();

}  // namespace airtruth::aircraft
