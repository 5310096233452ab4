// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Names that people type: the names of enums, patterns with * and ?, and the nearest spelling of a
// name that is not known.
namespace airtruth {

// Enums whose values have names in files. The module that owns an enum writes one table of the
// names beside it, as a function that argument-dependent lookup finds:
//
//   enum class Method { kMatte, kChromaKey };
//   constexpr auto enum_names(Method) {
//     return std::to_array<EnumName<Method>>(
//         {{Method::kMatte, "matte"}, {Method::kChromaKey, "chroma-key"}});
//   }
//   enum_name(Method::kMatte)           -> "matte"
//   enum_named<Method>("chroma-key")    -> Method::kChromaKey
//   enum_named<Method>("mat")           -> empty
template <typename Enum>
struct EnumName {
  Enum value;
  // A string literal.
  const char* name;
};

// The name of a value; nullptr where the table lacks the value.
template <typename Enum>
constexpr const char* enum_name(Enum value) {
  for (const EnumName<Enum>& known : enum_names(value))
    if (known.value == value) return known.name;
  return nullptr;
}

// The name of a value, or `otherwise` where there is none.
template <typename Enum>
std::string enum_name(const std::optional<Enum>& value, const char* otherwise) {
  return value ? enum_name(*value) : otherwise;
}

// The value of that name; empty where no value has it. Letter case matters.
template <typename Enum>
constexpr std::optional<Enum> enum_named(std::string_view name) {
  for (const EnumName<Enum>& known : enum_names(Enum{}))
    if (known.name == name) return known.value;
  return std::nullopt;
}

// All names, in the order of the table.
template <typename Enum>
std::vector<std::string> all_enum_names() {
  std::vector<std::string> names;
  for (const EnumName<Enum>& known : enum_names(Enum{})) names.emplace_back(known.name);
  return names;
}

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

// "; did you mean 'seed'?" for the end of a message about an unknown word; `otherwise` where no
// candidate is near.
std::string did_you_mean(std::string_view word,
                         std::span<const std::string> candidates,
                         const std::string& otherwise = "");

// The `count` candidates with the smallest edit distances, the smallest first, whatever the
// distances are. Equal distances keep the order of the candidates.
std::vector<std::string> nearest_spellings(std::string_view word,
                                           std::span<const std::string> candidates,
                                           std::size_t count);

}  // namespace airtruth
