// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace airtruth {

// The deepest nesting of lists and objects that a JSON text may have. nlohmann::json copies,
// compares and writes a value by recursion, so a deeper text could exhaust a thread's stack. The
// formats of this project and of others that it reads have at most 8 levels.
constexpr int kMostNesting = 64;

// True where the text nests its lists and objects deeper than kMostNesting. The text need not be
// valid.
bool is_nested_too_deep(std::string_view json);

// The value of a text from a file or a program. It is discarded (is_discarded()) where the text is
// not JSON or is nested too deep.
nlohmann::ordered_json parse_json(std::string_view text);

}  // namespace airtruth
