// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace airtruth {

// Whether upper and lower case are two letters or one. Only ASCII letters have a case here.
enum class LetterCase { kMatters, kIgnored };

// Whether the whole name fits a pattern in which * stands for any characters, none among them, and
// ? for exactly one. Time is at most proportional to the product of both lengths.
bool matches(std::string_view pattern,
             std::string_view name,
             LetterCase letter_case = LetterCase::kMatters);

// Whether `part` occurs in `text`, whatever the case of its letters.
bool contains_ignoring_case(std::string_view text, std::string_view part);

// Whether a name is one of those that a word asks for: one that the pattern fits, or one that
// contains the word where it is no pattern; whatever the case of their letters.
bool is_named_like(std::string_view name, std::string_view word);

// Whether the text holds * or ?, so that it is a pattern and no plain name.
bool is_pattern(std::string_view text);

}  // namespace airtruth
