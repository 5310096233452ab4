// SPDX-License-Identifier: Apache-2.0
#include "foundation/base/names.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <numeric>

namespace airtruth {

bool matches(std::string_view pattern, std::string_view name, LetterCase letter_case) {
  if (letter_case == LetterCase::kIgnored) return matches(lower_case(pattern), lower_case(name));
  std::size_t p = 0;
  std::size_t n = 0;
  std::size_t star = std::string_view::npos;  // the last * in the pattern, for backtracking
  std::size_t met = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] != '*' && (pattern[p] == '?' || pattern[p] == name[n])) {
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
  return lower_case(text).find(lower_case(part)) != std::string::npos;
}

bool is_pattern(std::string_view text) { return text.find_first_of("*?") != text.npos; }

bool is_named_like(std::string_view name, std::string_view word) {
  return is_pattern(word) ? matches(word, name, LetterCase::kIgnored)
                          : contains_ignoring_case(name, word);
}

namespace {

int exact_distance(std::string_view a, std::string_view b) {
  const std::size_t width = b.size() + 1;
  std::vector<int> before(width), previous(width), current(width);
  std::iota(previous.begin(), previous.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    current[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int substitution = previous[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      current[j] = std::min({previous[j] + 1, current[j - 1] + 1, substitution});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) current[j] = std::min(current[j], before[j - 2] + 1);
    }
    std::swap(before, previous);
    std::swap(previous, current);
  }
  return previous[b.size()];
}

}  // namespace

int edit_distance(std::string_view a, std::string_view b) {
  const int with_case = exact_distance(a, b);
  const int without_case = exact_distance(lower_case(a), lower_case(b));
  return without_case + (with_case - without_case) / 3;
}

std::string did_you_mean(std::string_view word,
                         std::span<const std::string> candidates,
                         const std::string& otherwise) {
  const auto near = nearest_spelling(word, candidates);
  return near ? "; did you mean '" + *near + "'?" : otherwise;
}

std::vector<std::string> nearest_spellings(std::string_view word,
                                           std::span<const std::string> candidates,
                                           std::size_t count) {
  std::vector<std::pair<int, std::string>> ranked;
  ranked.reserve(candidates.size());
  for (const auto& candidate : candidates)
    ranked.emplace_back(edit_distance(word, candidate), candidate);
  std::stable_sort(
      ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> result;
  for (std::size_t i = 0; i < std::min(count, ranked.size()); ++i)
    result.push_back(ranked[i].second);
  return result;
}

std::optional<std::string> nearest_spelling(std::string_view word,
                                            std::span<const std::string> candidates) {
  const auto best = nearest_spellings(word, candidates, 1);
  if (best.empty()) return std::nullopt;
  const int limit = std::max<int>(2, static_cast<int>(word.size()) / 3);
  if (edit_distance(word, best[0]) > limit) return std::nullopt;
  return best[0];
}

}  // namespace airtruth
