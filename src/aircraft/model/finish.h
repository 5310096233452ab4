// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace airtruth::model {

// How a surface reflects light, apart from its colour.
enum class Finish : std::uint8_t {
  kPaint,  // diffuse under a clear coat that reflects
  kGlass,  // reflects as the clear coat does, above a dark interior
  kMetal,  // reflects, tinted by its colour, without a diffuse part
  kMat,    // diffuse without a reflection
};
// The number of finishes.
constexpr std::uint8_t kFinishes = 4;

// The finish that the words of a material's name in its file state. A word is a run of letters in
// any case. docs/aircraft.md lists the words for glass and metal. Other names are paint.
Finish finish_named(std::string_view material);

}  // namespace airtruth::model
