// SPDX-License-Identifier: Apache-2.0
#pragma once

// Units of aviation and standard gravity in SI. All are exact: the international foot (1959), the
// international nautical mile (1929) and the standard acceleration of gravity (3rd CGPM, 1901).
namespace airtruth {

constexpr double kMetresOfFoot = 0.3048;
constexpr double kMetresOfNauticalMile = 1852;
constexpr double kMpsOfKnot = kMetresOfNauticalMile / 3600;
constexpr double kMpsOfFootPerMinute = kMetresOfFoot / 60;
constexpr double kStandardGravityMps2 = 9.80665;

}  // namespace airtruth
