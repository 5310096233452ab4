// SPDX-License-Identifier: Apache-2.0
#include "studio/messages/target.h"

#include <algorithm>
#include <charconv>

#include "foundation/base/text.h"

namespace airtruth::messages {
namespace {

constexpr std::size_t kMostBytes = 2048;

std::optional<std::string> unescaped(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      result += text[i] == '+' ? ' ' : text[i];
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

}  // namespace

std::string Target::value(const std::string& key) const {
  const auto found = query.find(key);
  return found == query.end() ? "" : found->second;
}

std::optional<std::int64_t> Target::whole(const std::string& key,
                                          std::int64_t least,
                                          std::int64_t most) const {
  const auto number = number_from_text<std::int64_t>(value(key));
  return number && *number >= least && *number <= most ? number : std::nullopt;
}

std::optional<Target> target_from(std::string_view text) {
  if (text.empty() || text.size() > kMostBytes || text[0] != '/') return std::nullopt;
  const std::size_t mark = std::min(text.find('?'), text.size());
  Target target{std::string(text.substr(0, mark)), {}};
  for (std::size_t begin = mark + 1; begin < text.size();) {
    const std::size_t end = std::min(text.find('&', begin), text.size());
    const std::size_t equals = std::min(text.find('=', begin), end);
    const auto key = unescaped(text.substr(begin, equals - begin));
    const std::size_t value_begin = std::min(equals + 1, end);
    const auto value = unescaped(text.substr(value_begin, end - value_begin));
    if (!key || !value) return std::nullopt;
    target.query[*key] = *value;
    begin = end + 1;
  }
  return target;
}

std::optional<ByteRange> range_from(std::string_view header,
                                    std::uint64_t size,
                                    std::uint64_t most) {
  constexpr std::string_view kUnit = "bytes=";
  if (!header.starts_with(kUnit) || size == 0) return std::nullopt;
  const std::size_t dash = header.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const auto first =
      number_from_text<std::uint64_t>(header.substr(kUnit.size(), dash - kUnit.size()));
  const auto last = number_from_text<std::uint64_t>(header.substr(dash + 1));
  if (!first && dash > kUnit.size()) return std::nullopt;
  if (!last && dash + 1 < header.size()) return std::nullopt;
  if (!first && !last) return std::nullopt;
  ByteRange range;
  // "-500": the last 500.
  range.first = first ? *first : size - std::min(size, *last);
  range.last = std::min(first && last ? *last : size - 1, size - 1);
  if (range.first > range.last) return std::nullopt;
  range.last = std::min(range.last, range.first + most - 1);
  return range;
}

}  // namespace airtruth::messages
