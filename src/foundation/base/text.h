// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "foundation/base/error.h"

// Small work on the text of files: blanks, lines, cells, quoted words, and base64.
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

// The text without the byte order mark that some editors write before UTF-8.
inline std::string_view without_mark(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return text;
}

// The words of a text, with blanks between them.
//
//   words_in("name seed") is {"name", "seed"}
template <typename Text = std::string>
std::vector<Text> words_in(std::string_view text) {
  std::vector<Text> words;
  while (!(text = trimmed(text)).empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    words.emplace_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return words;
}

// Whether the character controls a terminal or a parser, and shows nothing: ASCII's C0 set and DEL.
constexpr bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

// The first `most` bytes of a text for a message of one line, with '?' for each that is no
// printable ASCII.
std::string printable(std::string_view text, std::size_t most = 40);

// The same in quotes. A text that goes on ends with "...".
std::string quoted_excerpt(std::string_view text, std::size_t most);

// The line, counted from 1, of the byte at `offset` in the text, for messages about text that a
// parser knows by its offset. An offset outside of the text means its nearest end.
//
//   line_of("a\nb", 0) == 1, line_of("a\nb", 2) == 2, line_of("a\nb", 99) == 2
inline int line_of(std::string_view text, std::ptrdiff_t offset) {
  const auto end = text.begin() + std::clamp<std::ptrdiff_t>(offset, 0, std::ssize(text));
  return 1 + static_cast<int>(std::count(text.begin(), end, '\n'));
}

// The cells of a line, split at its commas or another character. Blanks and carriage returns around
// a cell are removed. Quotes have no meaning.
std::vector<std::string> cells_of(std::string_view line, char between = ',');

// The text as a cell of a CSV file: in quotes where it holds a comma, a quote or a line end (RFC
// 4180).
std::string csv_cell(std::string_view text);

// The text as a basic string of a TOML file, in its quotes (TOML 1.0, "String").
//
//   toml_string("a\"b\n") is "a\"b\n" as a programmer would write it: eight characters
std::string toml_string(std::string_view text);

// The text as one word of a shell command, in single quotes.
std::string shell_word(std::string_view text);
// The name of a file as it can be pasted into a shell: as it is where that is one word. One that
// begins with a dash would be an option.
std::string pasted(std::string_view file);

// The text with the bytes that its %XX stand for (RFC 3986, 2.1); empty where a % begins none.
std::optional<std::string> percent_decoded(std::string_view text);

// The whole text as a number; empty where it is none, or one that the type does not hold.
//
//   number_from_text<int>("12") == 12; "12 ", "+12" and "" are none
template <typename Number>
std::optional<Number> number_from_text(std::string_view text) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto [rest, failed] = std::from_chars(text.data(), end, value);
  return failed == std::errc() && rest == end ? std::optional(value) : std::nullopt;
}

// The cell as a number. Throws Error where it is not a number or not finite.
double finite_number(const std::string& cell, const Where& where);

// Where a column stands that a header lacks.
inline constexpr std::size_t kNoColumn = std::string::npos;

// Where each of the names stands among the cells of a header. Throws Error for a cell that is none
// of them, with the nearest one, and for a name that stands there twice.
std::vector<std::size_t> places_of(const std::vector<std::string>& names,
                                   const std::vector<std::string>& header,
                                   const Where& where);

// The base64 text of bytes, with padding (RFC 4648).
std::string base64_of(std::string_view bytes);

}  // namespace airtruth
