// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "foundation/base/error.h"

namespace airtruth {

// The cells of a line, split at its commas. Blanks and carriage returns around a cell are removed.
// Quotes have no meaning.
std::vector<std::string> cells_of(std::string_view line);

// The cell as a number. Throws Error where it is not a number or not finite.
double finite_number(const std::string& cell, const Where& where);

}  // namespace airtruth
