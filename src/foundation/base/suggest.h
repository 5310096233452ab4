// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace airtruth {

// The number of insertions, deletions and substitutions of one character and of swaps of
// neighbouring characters that turn a into b (Damerau 1964, in the restricted form that edits no
// part of the text twice). Three differences in letter case count as one edit, rounded down.
//
//   edit_distance("sedd", "seed") == 1, edit_distance("SEED", "seed") == 1
int edit_distance(std::string_view a, std::string_view b);

// The candidate with the smallest edit distance to `word`. It is empty where that distance exceeds
// a third of the length of `word` and 2, or where there are no candidates.
std::optional<std::string> nearest_spelling(std::string_view word,
                                            std::span<const std::string> candidates);

// The `count` candidates with the smallest edit distances, the smallest first, whatever the
// distances are. Equal distances keep the order of the candidates.
std::vector<std::string> nearest_spellings(std::string_view word,
                                           std::span<const std::string> candidates,
                                           std::size_t count);

}  // namespace airtruth
