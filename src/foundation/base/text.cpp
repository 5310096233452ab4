// SPDX-License-Identifier: Apache-2.0
#include "foundation/base/text.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/evp.h>

#include "foundation/base/names.h"

namespace airtruth {

std::vector<std::string> cells_of(std::string_view line, char between) {
  std::vector<std::string> cells;
  while (!line.empty()) {
    const std::size_t end = std::min(line.find(between), line.size());
    cells.emplace_back(trimmed(line.substr(0, end)));
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return cells;
}

std::string printable(std::string_view text, std::size_t most) {
  std::string shown(text.substr(0, most));
  for (char& c : shown)
    if (c < ' ' || c > '~') c = '?';
  return shown;
}

std::string quoted_excerpt(std::string_view text, std::size_t most) {
  return "'" + printable(text, most) + (text.size() > most ? "...'" : "'");
}

std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char letter : text) quoted += letter == '"' ? "\"\"" : std::string(1, letter);
  return quoted + "\"";
}

std::string toml_string(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      result += {'\\', c};
    else if (c == '\n')
      result += "\\n";
    else if (c == '\t')
      result += "\\t";
    else if (is_control(c))
      result += fmt::format("\\u{:04X}", int{c});
    else
      result += c;
  }
  return result + '"';
}

std::string shell_word(std::string_view text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + "'";
}

std::string pasted(std::string_view file) {
  const std::string name = (file.starts_with('-') ? "./" : "") + std::string(file);
  const bool is_plain = std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view("._-/").find(static_cast<char>(c)) != std::string_view::npos;
  });
  return is_plain ? name : shell_word(name);
}

std::optional<std::string> percent_decoded(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      result += text[i];
      continue;
    }
    unsigned code = 0;
    if (i + 2 >= text.size()) return std::nullopt;
    const char* end = text.data() + i + 3;
    const auto [at, fault] = std::from_chars(text.data() + i + 1, end, code, 16);
    if (fault != std::errc() || at != end) return std::nullopt;
    result += static_cast<char>(code);
    i += 2;
  }
  return result;
}

double finite_number(const std::string& cell, const Where& where) {
  const auto value = number_from_text<double>(cell);
  if (!value || !std::isfinite(*value))
    throw Error("'" + cell.substr(0, 40) + "' is not a finite number", where);
  return *value;
}

std::vector<std::size_t> places_of(const std::vector<std::string>& names,
                                   const std::vector<std::string>& header,
                                   const Where& where) {
  std::vector<std::size_t> places(names.size(), kNoColumn);
  for (std::size_t i = 0; i < header.size(); ++i) {
    const std::string shown = header[i].substr(0, 40);
    const auto known = std::find(names.begin(), names.end(), header[i]);
    if (known == names.end())
      throw Error(
          "unknown column '" + shown + "'" +
              did_you_mean(header[i], names, fmt::format("; expected {}", fmt::join(names, ","))),
          where);
    std::size_t& place = places[static_cast<std::size_t>(known - names.begin())];
    if (place != kNoColumn)
      throw Error("the column '" + shown + "' is twice there; expected it once", where);
    place = i;
  }
  return places;
}

std::string base64_of(std::string_view bytes) {
  // EVP_EncodeBlock writes a terminating zero after the text.
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int length = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                     reinterpret_cast<const unsigned char*>(bytes.data()),
                                     static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(length));
  return text;
}

}  // namespace airtruth
