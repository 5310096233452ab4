// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>

// Names of Debian's catalogue that cannot be drawn, or are no aircraft
// (data/aircraft-left-out/README.md). They are not offered.
namespace airtruth::aircraft {

// The content of data/aircraft-left-out/left-out.csv, which the build embeds in the program. It has
// a line per name: the name and the reason, below one heading.
std::string_view left_out_table();

// The reason why a name is left out, by the name.
const std::map<std::string, std::string>& left_out();

}  // namespace airtruth::aircraft
