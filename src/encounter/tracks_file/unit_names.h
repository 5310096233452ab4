// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

// Units as the files of DAIDALUS and of MIT Lincoln Laboratory name them.
namespace airtruth::encounter {

enum class Dimension { kNone, kLength, kAngle, kSpeed, kTime };

// The factor from the unit to metres, radians, metres per second or seconds; 1 for a unit of
// kNone. Square brackets around the name are left out. Empty where the dimension has no such unit.
//
//   factor_of("[nmi]", Dimension::kLength) == 1852
std::optional<double> factor_of(std::string_view unit, Dimension dimension);

// True where the word is the name of any unit, or stands in square brackets.
bool is_unit_word(std::string_view word);

// The names of a dimension's units, for messages: "m, km, ft, nmi".
std::string units_of(Dimension dimension);

}  // namespace airtruth::encounter
