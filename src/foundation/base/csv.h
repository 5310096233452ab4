// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "foundation/base/error.h"

namespace airtruth {

// A line between its commas, blanks and carriage returns trimmed; nothing is quoted.
std::vector<std::string> cells_of(std::string_view line);

// The cell as a number. Error where it is none, or not finite.
double finite_number(const std::string& cell, const Where& where);

}  // namespace airtruth
