// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <airtruth/error.h>

namespace airtruth {

// The place as messages state it: "scene.toml:12:3" (file, line, column), "scene.toml" where the
// line is not known, or "" where the file is not known. Error itself is in airtruth/error.h.
std::string to_string(const Where& where);

// The text with '?' for each NUL, at which the text of an exception would end: what() is a C
// string. Error's own is without.
std::string without_nul(std::string_view text);

// Checks an invariant of the program. A false condition is a bug: the function throws
// std::logic_error, and the program ends with exit code 1. Release builds keep the check.
void check(bool condition, std::string_view what);

}  // namespace airtruth
