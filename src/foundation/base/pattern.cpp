// SPDX-License-Identifier: Apache-2.0
#include "foundation/base/pattern.h"

#include <algorithm>
#include <cctype>
#include <cstddef>

namespace airtruth {
namespace {

bool same_letter(char a, char b, LetterCase letter_case) {
  if (letter_case == LetterCase::kMatters) return a == b;
  return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

}  // namespace

bool matches(std::string_view pattern, std::string_view name, LetterCase letter_case) {
  std::size_t p = 0;
  std::size_t n = 0;
  std::size_t star = std::string_view::npos;  // the last * in the pattern, for backtracking
  std::size_t met = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] != '*' &&
        (pattern[p] == '?' || same_letter(pattern[p], name[n], letter_case))) {
      ++p, ++n;
    } else if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      met = n;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++met;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

bool contains_ignoring_case(std::string_view text, std::string_view part) {
  return std::search(text.begin(), text.end(), part.begin(), part.end(), [](char a, char b) {
           return same_letter(a, b, LetterCase::kIgnored);
         }) != text.end();
}

bool is_pattern(std::string_view text) { return text.find_first_of("*?") != text.npos; }

bool is_named_like(std::string_view name, std::string_view word) {
  return is_pattern(word) ? matches(word, name, LetterCase::kIgnored)
                          : contains_ignoring_case(name, word);
}

}  // namespace airtruth
