// SPDX-License-Identifier: Apache-2.0
#include "aircraft/wrapper/condition.h"

#include <algorithm>

namespace airtruth::aircraft {
namespace {

constexpr double kGearUpAboveFt = 500;
constexpr double kPropellerRpm = 2300;
constexpr double kMainRotorRpm = 300;
constexpr double kTailRotorRpm = 1500;
constexpr double kFpsFromKt = 1.68781;
constexpr double kKtOfMach1 = 661.5;

bool contains(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

double property_value(const std::string& property, const Cruise& cruise) {
  const bool of_wheels = contains(property, "gear/gear");
  const double gear_down = cruise.altitude_agl_ft > kGearUpAboveFt ? 0 : 1;
  if (of_wheels) return contains(property, "position-norm") ? gear_down : 0;
  if (contains(property, "gear-down")) return gear_down;
  if (contains(property, "speed-kt")) return cruise.airspeed_kt;  // air and ground
  if (contains(property, "uBody-fps")) return cruise.airspeed_kt * kFpsFromKt;
  if (contains(property, "velocities/mach")) return cruise.airspeed_kt / kKtOfMach1;
  if (contains(property, "altitude-agl-ft") || contains(property, "altitude-ft"))
    return cruise.altitude_agl_ft;
  if (contains(property, "rotors/main/rpm")) return kMainRotorRpm;
  if (contains(property, "rotors/tail/rpm")) return kTailRotorRpm;
  if (contains(property, "engine") && contains(property, "rpm")) return kPropellerRpm;
  if (contains(property, "/n1") || contains(property, "/n2")) return 80;
  if (contains(property, "running")) return 1;
  return 0;  // surfaces, canopies, switches, speed brakes at rest
}

bool holds(const Condition& c, const Cruise& cruise) {
  using Kind = Condition::Kind;
  const auto value = [&] { return property_value(c.property, cruise); };
  const double other = c.other_property ? property_value(*c.other_property, cruise) : c.value;
  const auto part_holds = [&](const Condition& part) { return holds(part, cruise); };
  switch (c.kind) {
    case Kind::kAnd:
      return std::all_of(c.parts.begin(), c.parts.end(), part_holds);
    case Kind::kOr:
      return std::any_of(c.parts.begin(), c.parts.end(), part_holds);
    case Kind::kNot:
      return !std::all_of(c.parts.begin(), c.parts.end(), part_holds);
    case Kind::kLess:
      return value() < other;
    case Kind::kLessEquals:
      return value() <= other;
    case Kind::kGreater:
      return value() > other;
    case Kind::kGreaterEquals:
      return value() >= other;
    case Kind::kEquals:
      return !c.compares_text && value() == other;
    case Kind::kNotEquals:
      return c.compares_text || value() != other;
    case Kind::kTrue:
      return value() != 0;
  }
  return true;
}

double value_of(const Driven& driven, const Cruise& cruise) {
  const double x = driven.property.empty() ? 0 : property_value(driven.property, cruise);
  const auto& table = driven.table;
  if (table.empty()) {
    double value = driven.factor * x + driven.offset;
    if (driven.least) value = std::max(value, *driven.least);
    if (driven.most) value = std::min(value, *driven.most);
    return value;
  }
  if (x <= table.front().first) return table.front().second;
  for (std::size_t i = 1; i < table.size(); ++i) {
    if (x > table[i].first) continue;
    const double span = table[i].first - table[i - 1].first;
    const double t = span > 0 ? (x - table[i - 1].first) / span : 1;
    return table[i - 1].second + t * (table[i].second - table[i - 1].second);
  }
  return table.back().second;
}

}  // namespace airtruth::aircraft
