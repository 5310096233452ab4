// SPDX-License-Identifier: Apache-2.0
#pragma once

// Units of aviation in SI. All are exact: the international foot (1959) and the international
// nautical mile (1929).
namespace airtruth::encounter {

constexpr double kMetresOfFoot = 0.3048;
constexpr double kMetresOfNauticalMile = 1852;
constexpr double kMpsOfKnot = kMetresOfNauticalMile / 3600;
constexpr double kMpsOfFootPerMinute = kMetresOfFoot / 60;

}  // namespace airtruth::encounter
