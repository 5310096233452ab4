// SPDX-License-Identifier: Apache-2.0
#include "labels/exchange/python_json.h"

#include <cctype>
#include <string>

#include "foundation/base/files.h"

namespace airtruth::exchange {
namespace {

constexpr std::size_t kLargestFile_bytes = std::size_t{8} << 30;

// The letters from `at` on, in lower case. No word of the accepted JSON is longer than Infinity.
std::string word_at(const std::string& text, std::size_t at) {
  std::string word;
  while (at < text.size() && word.size() < 9 &&
         std::isalpha(static_cast<unsigned char>(text[at])) != 0)
    word += static_cast<char>(std::tolower(static_cast<unsigned char>(text[at++])));
  return word;
}

// Outside of strings NaN, Infinity and -Infinity are replaced by null.
std::string without_python_words(std::string text) {
  std::string result;
  std::size_t copied = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') {
      ++i;
      while (i < text.size() && text[i] != '"') i += text[i] == '\\' ? 2 : 1;
      continue;
    }
    if (text[i] != 'n' && text[i] != 'N' && text[i] != 'i' && text[i] != 'I') continue;
    const std::string word = word_at(text, i);
    if (word == "nan" || word == "inf" || word == "infinity") {
      const bool has_sign = i > copied && (text[i - 1] == '-' || text[i - 1] == '+');
      result.append(text, copied, i - copied - (has_sign ? 1 : 0)).append("null");
      copied = i + word.size();
    }
    i += word.size() - 1;
  }
  if (copied == 0) return text;
  return result.append(text, copied);
}

}  // namespace

JsonDocument python_json(const std::filesystem::path& file) {
  return {without_python_words(read_file(file, kLargestFile_bytes)), Where{file.string()}};
}

}  // namespace airtruth::exchange
