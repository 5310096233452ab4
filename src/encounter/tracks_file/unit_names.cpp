// SPDX-License-Identifier: Apache-2.0
#include "encounter/tracks_file/unit_names.h"

#include <algorithm>
#include <array>

#include "encounter/track/units.h"
#include "foundation/geometry/transform.h"

namespace airtruth::encounter {
namespace {

struct Unit {
  std::string_view name;
  Dimension dimension;
  double factor;
  // True for one name of each unit, which messages use.
  bool is_shown = false;
};

constexpr auto kUnits = std::to_array<Unit>({
    {"none", Dimension::kNone, 1, true},
    {"unitless", Dimension::kNone, 1, true},
    {"unspecified", Dimension::kNone, 1},
    {"m", Dimension::kLength, 1, true},
    {"meter", Dimension::kLength, 1},
    {"metre", Dimension::kLength, 1},
    {"km", Dimension::kLength, 1000, true},
    {"ft", Dimension::kLength, kMetresOfFoot, true},
    {"feet", Dimension::kLength, kMetresOfFoot},
    {"foot", Dimension::kLength, kMetresOfFoot},
    {"nmi", Dimension::kLength, kMetresOfNauticalMile, true},
    {"nm", Dimension::kLength, kMetresOfNauticalMile},
    {"NM", Dimension::kLength, kMetresOfNauticalMile},
    {"deg", Dimension::kAngle, radians(1), true},
    {"degree", Dimension::kAngle, radians(1)},
    {"rad", Dimension::kAngle, 1, true},
    {"radian", Dimension::kAngle, 1},
    {"m/s", Dimension::kSpeed, 1, true},
    {"mps", Dimension::kSpeed, 1},
    {"km/h", Dimension::kSpeed, 1 / 3.6, true},
    {"kph", Dimension::kSpeed, 1 / 3.6},
    {"knot", Dimension::kSpeed, kMpsOfKnot, true},
    {"kn", Dimension::kSpeed, kMpsOfKnot},
    {"kt", Dimension::kSpeed, kMpsOfKnot},
    {"kts", Dimension::kSpeed, kMpsOfKnot},
    {"fpm", Dimension::kSpeed, kMpsOfFootPerMinute, true},
    {"ft/min", Dimension::kSpeed, kMpsOfFootPerMinute},
    {"ftps", Dimension::kSpeed, kMetresOfFoot, true},
    {"fps", Dimension::kSpeed, kMetresOfFoot},
    {"ft/s", Dimension::kSpeed, kMetresOfFoot},
    {"s", Dimension::kTime, 1, true},
    {"sec", Dimension::kTime, 1},
    {"ms", Dimension::kTime, 1e-3},
    {"min", Dimension::kTime, 60, true},
    {"h", Dimension::kTime, 3600, true},
    {"hour", Dimension::kTime, 3600},
});

std::string_view without_brackets(std::string_view word) {
  if (word.size() >= 2 && word.front() == '[' && word.back() == ']')
    return word.substr(1, word.size() - 2);
  return word;
}

}  // namespace

std::optional<double> factor_of(std::string_view unit, Dimension dimension) {
  const std::string_view name = without_brackets(unit);
  for (const Unit& known : kUnits)
    if (known.dimension == dimension && known.name == name) return known.factor;
  return std::nullopt;
}

bool is_unit_word(std::string_view word) {
  return without_brackets(word) != word ||
         std::any_of(
             kUnits.begin(), kUnits.end(), [&](const Unit& unit) { return unit.name == word; });
}

std::string units_of(Dimension dimension) {
  std::string names;
  for (const Unit& unit : kUnits)
    if (unit.dimension == dimension && unit.is_shown)
      names += (names.empty() ? "" : ", ") + std::string(unit.name);
  return names;
}

}  // namespace airtruth::encounter
