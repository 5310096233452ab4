// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace airtruth {

// Number of single-character insertions, deletions, substitutions and swaps of neighbours that turn
// a into b (Damerau 1964, restricted form). Letter case counts as a third of an edit, rounded down
// over the whole word.
int edit_distance(std::string_view a, std::string_view b);

// The candidate nearest to `word`, or empty if no candidate is near enough to be a misspelling.
std::optional<std::string> nearest_spelling(std::string_view word,
                                            std::span<const std::string> candidates);

// The `count` candidates nearest to `word`, best first, whatever their distance.
std::vector<std::string> nearest_spellings(std::string_view word,
                                           std::span<const std::string> candidates,
                                           std::size_t count);

}  // namespace airtruth
