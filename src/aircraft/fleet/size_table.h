// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace airtruth::aircraft {

// The content of data/aircraft-sizes/sizes.csv, which the build embeds in the program.
// published_sizes() in scale.h parses it; data/aircraft-sizes/README.md describes the columns and
// the sources.
std::string_view size_table();

}  // namespace airtruth::aircraft
