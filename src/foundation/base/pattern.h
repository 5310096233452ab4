// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace airtruth {

// Whether a comparison distinguishes upper and lower case. Only ASCII letters have a case here.
enum class LetterCase { kMatters, kIgnored };

// Whether the whole name matches a pattern, in which * stands for any number of characters (or
// none) and ? for exactly one. The time is at most proportional to the product of both lengths.
bool matches(std::string_view pattern,
             std::string_view name,
             LetterCase letter_case = LetterCase::kMatters);

// The text with its ASCII capitals as small letters.
std::string lower_case(std::string_view text);

// Whether `part` occurs in `text`, whatever the case of its letters.
bool contains_ignoring_case(std::string_view text, std::string_view part);

// Whether a name matches a word without regard to letter case. A word with * or ? is a pattern for
// the whole name; any other word matches the names that contain it.
bool is_named_like(std::string_view name, std::string_view word);

// Whether the text contains * or ?, which makes it a pattern.
bool is_pattern(std::string_view text);

}  // namespace airtruth
