// SPDX-License-Identifier: Apache-2.0
#include "aircraft/ac3d/ac_tokens.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "foundation/base/error.h"

namespace airtruth::ac3d {
namespace {

// A bound for untrusted files, far above any name.
constexpr std::size_t kMaxNameBytes = 4096;
constexpr std::size_t kQuotedBytes = 40;  // the part of a faulty word that a message repeats

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f';
}

// The word in a form that fits into a message of one line.
std::string quoted_word(std::string_view word) {
  if (word.empty()) return "the end of the file";
  std::string text(word.substr(0, kQuotedBytes));
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || static_cast<unsigned char>(c) > '~') c = '?';
  return "'" + text + (word.size() > kQuotedBytes ? "...'" : "'");
}

// Like from_chars, but accepts a leading plus and reads a number too small for the type as zero.
bool parse_float(std::string_view word, double& value) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const char* end = word.data() + word.size();
  float single = 0;
  const auto as_float = std::from_chars(word.data(), end, single);
  value = static_cast<double>(single);
  if (as_float.ec == std::errc()) return as_float.ptr == end;
  if (as_float.ec != std::errc::result_out_of_range || as_float.ptr != end) return false;
  const auto as_double = std::from_chars(word.data(), end, value);
  if (as_double.ec == std::errc()) return true;
  value = word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos
              ? 0
              : HUGE_VAL;
  return true;
}

}  // namespace

void AcTokens::fail(const std::string& message) const {
  throw Error(message, {name_.string(), line_});
}

void AcTokens::skip_space() {
  while (at_ < text_.size() && is_space(text_[at_])) {
    if (text_[at_] == '\n') ++line_at_;
    ++at_;
  }
}

std::string_view AcTokens::word() {
  skip_space();
  line_ = line_at_;
  const std::size_t begin = at_;
  while (at_ < text_.size() && !is_space(text_[at_])) ++at_;
  return text_.substr(begin, at_ - begin);
}

std::string AcTokens::string() {
  skip_space();
  line_ = line_at_;
  std::string_view found;
  if (at_ < text_.size() && text_[at_] == '"') {
    const auto close = text_.find('"', at_ + 1);
    if (close == std::string_view::npos) fail("has a quoted name without its second quote");
    found = text_.substr(at_ + 1, close - at_ - 1);
    at_ = close + 1;
    line_at_ += static_cast<int>(std::count(found.begin(), found.end(), '\n'));
  } else {
    found = word();
  }
  if (found.size() > kMaxNameBytes)
    fail(fmt::format("has a name of {} bytes; expected at most {}", found.size(), kMaxNameBytes));
  return std::string(found);
}

float AcTokens::number(const char* what, double largest) {
  const std::string_view text = word();
  double value = 0;
  if (text.empty() || !parse_float(text, value))
    fail(fmt::format("{} is {}; expected a number", what, quoted_word(text)));
  if (!(std::abs(value) <= largest))
    fail(fmt::format(
        "{} is {}; expected at most {:g} either way", what, quoted_word(text), largest));
  return static_cast<float>(value);
}

std::uint32_t AcTokens::count(const char* what, std::uint64_t largest) {
  const std::string_view text = word();
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  const std::string_view digits = hexadecimal ? text.substr(2) : text;
  std::uint64_t value = 0;
  const char* end = digits.data() + digits.size();
  const auto [rest, failed] = std::from_chars(digits.data(), end, value, hexadecimal ? 16 : 10);
  if (digits.empty() || failed != std::errc() || rest != end || value > largest)
    fail(fmt::format(
        "{} is {}; expected a whole number up to {}", what, quoted_word(text), largest));
  return static_cast<std::uint32_t>(value);
}

void AcTokens::expect(std::string_view wanted) {
  const std::string_view found = word();
  if (found != wanted)
    fail(fmt::format("has {} where '{}' is expected", quoted_word(found), wanted));
}

void AcTokens::skip_line() {
  const auto end = text_.find('\n', at_);
  at_ = end == std::string_view::npos ? text_.size() : end;
}

void AcTokens::skip_bytes(std::size_t bytes) {
  const std::size_t end = at_ + std::min(bytes, bytes_left());
  line_at_ += static_cast<int>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(at_),
                                          text_.begin() + static_cast<std::ptrdiff_t>(end),
                                          '\n'));
  at_ = end;
}

}  // namespace airtruth::ac3d
