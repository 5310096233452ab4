// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace airtruth {

// The text without the blanks, tabs and line ends around it.
//
//   trimmed(" a b\r\n") == "a b", trimmed(" ") == ""
inline std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

}  // namespace airtruth
