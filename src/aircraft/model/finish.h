// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace airtruth::aircraft {

// What a surface does with light, but for its colour.
enum class Finish : std::uint8_t {
  kPaint,  // scatters, under a clear coat that mirrors
  kGlass,  // mirrors as the clear coat does, over a dark inside
  kMetal,  // mirrors, tinted by its colour, and scatters nothing
  kMat,    // scatters, and mirrors nothing
};
constexpr std::uint8_t kFinishes = 4;

// By the words of a material's name in its file: runs of letters, in any case. docs/aircraft.md
// lists those that say glass or metal. Paint where none does.
Finish finish_named(std::string_view material);

}  // namespace airtruth::aircraft
