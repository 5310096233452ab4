// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace airtruth {

// The line, counted from 1, of the byte at `offset` in the text, for messages about text that a
// parser knows by its offset. An offset outside of the text means its nearest end.
//
//   line_of("a\nb", 0) == 1, line_of("a\nb", 2) == 2, line_of("a\nb", 99) == 2
inline int line_of(std::string_view text, std::ptrdiff_t offset) {
  const auto end = text.begin() + std::clamp<std::ptrdiff_t>(offset, 0, std::ssize(text));
  return 1 + static_cast<int>(std::count(text.begin(), end, '\n'));
}

}  // namespace airtruth
