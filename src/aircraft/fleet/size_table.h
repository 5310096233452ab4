// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace airtruth::aircraft {

// data/aircraft-sizes/sizes.csv, put into the program when it is built.
std::string_view size_table();

}  // namespace airtruth::aircraft
