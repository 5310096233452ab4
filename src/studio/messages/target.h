// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

// The words of an HTTP request that the server reads itself.
namespace airtruth::messages {

// "/thumb?frame=7&name=a%2Fb": the path as it stands, the values without their escapes.
struct Target {
  std::string path;
  std::map<std::string, std::string> query;

  // "" where it is missing.
  std::string value(const std::string& key) const;
  // Empty where it is no whole number from `least` to `most`.
  std::optional<std::int64_t> whole(const std::string& key,
                                    std::int64_t least,
                                    std::int64_t most) const;
};

// Empty for what is no target of this server: one that is too long, or has a wrong escape.
std::optional<Target> target_from(std::string_view text);

// The bytes that a header `Range: bytes=...` asks for of a file of `size`, first and last, at most
// `most` of them; empty for any other form, which means the whole file.
struct ByteRange {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
};
std::optional<ByteRange> range_from(std::string_view header,
                                    std::uint64_t size,
                                    std::uint64_t most);

}  // namespace airtruth::messages
