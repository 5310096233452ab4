// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"

#include <charconv>

#include "foundation/base/error.h"

namespace airtruth::cli {

std::pair<int, int> size_from(const std::string& text) {
  // Pixels: no video is larger.
  constexpr int kLargestSide = 65536;
  int width = 0;
  int height = 0;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, width);
  const bool parted = first.ec == std::errc() && first.ptr != end && *first.ptr == 'x';
  const auto second = parted ? std::from_chars(first.ptr + 1, end, height) : first;
  if (!parted || second.ec != std::errc() || second.ptr != end || width < 1 || height < 1 ||
      width > kLargestSide || height > kLargestSide)
    throw Error("--size is '" + text + "'; expected WIDTHxHEIGHT, as 1280x960");
  return {width, height};
}

}  // namespace airtruth::cli
