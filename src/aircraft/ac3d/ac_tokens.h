// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

// For ac_file.cpp alone: words and numbers of a text, with the line where they stand.
namespace airtruth::ac3d {

class AcTokens {
 public:
  AcTokens(std::string_view text, std::filesystem::path name)
      : text_(text), name_(std::move(name)) {}

  // The next word; empty at the end of the text.
  std::string_view word();
  // The next word or, between quotes, the next words.
  std::string string();
  // A number of magnitude up to `largest`.
  float number(const char* what, double largest);
  // A whole number up to `largest`; decimal, or hexadecimal after 0x.
  std::uint32_t count(const char* what, std::uint64_t largest);
  void expect(std::string_view wanted);
  void skip_line();
  void skip_bytes(std::size_t bytes);
  std::size_t bytes_left() const { return text_.size() - at_; }
  int line() const { return line_; }  // of the last word
  // An Error at the line of the last word.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  void skip_space();

  std::string_view text_;
  std::filesystem::path name_;
  std::size_t at_ = 0;
  int line_at_ = 1;  // where the next character stands
  int line_ = 1;
};

}  // namespace airtruth::ac3d
