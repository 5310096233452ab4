// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
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

// Where a column stands that a header lacks.
inline constexpr std::size_t kNoColumn = std::string::npos;

// Where each of the names stands among the cells of a header. Throws Error for a cell that is none
// of them, with the nearest one, and for a name that stands there twice.
std::vector<std::size_t> places_of(const std::vector<std::string>& names,
                                   const std::vector<std::string>& header,
                                   const Where& where);

}  // namespace airtruth
