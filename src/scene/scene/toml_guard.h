// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace airtruth::scene {

// Throws Error where the text nests deeper than any scene does: arrays in arrays, or
// a.long.dotted.key. The TOML parser and the destructors of its result are recursive, so a hostile
// file could otherwise exhaust the stack.
void refuse_deep_nesting(std::string_view text, const std::string& file);

}  // namespace airtruth::scene
