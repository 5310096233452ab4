// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "studio/document/change.h"

// Changes of a TOML text that leave all else as it is: comments, order, spacing, unknown keys.
namespace airtruth::document {

// The text with the change in it, made where its value stands. Each byte that does not belong to
// the value stays. What is written new ends its lines as the file does.
//
// Example: {"set": ["lens", "vertical_fov_deg"], "to": 61.5} turns
//   vertical_fov_deg = 60  # a guess
// into
//   vertical_fov_deg = 61.5  # a guess
//
// Throws Error where the text is not TOML, where the path leads nowhere, and where the change
// cannot be made in place; the text is read again to be sure that it says what was asked for.
std::string changed(std::string_view text, const Change& change, const std::string& file);

}  // namespace airtruth::document
