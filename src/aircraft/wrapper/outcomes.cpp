// SPDX-License-Identifier: Apache-2.0
#include "aircraft/wrapper/outcomes.h"

#include <fmt/format.h>

namespace airtruth::aircraft {

std::string outcomes_of(const Wrapper& wrapper, const Cruise& cruise) {
  const auto bit = [&](const Condition& condition) { return holds(condition, cruise) ? '1' : '0'; };
  // Every bit of the number counts.
  const auto number = [&](const Driven& driven) {
    return fmt::format("{:a},", value_of(driven, cruise));
  };
  std::string text = "(";
  for (const Condition& condition : wrapper.conditions) text += bit(condition);
  for (const Animation& animation : wrapper.animations) {
    if (animation.condition) text += bit(*animation.condition);
    text += number(animation.value);
    for (const Driven& scale : animation.scale) text += number(scale);
  }
  for (const Wrapper& nested : wrapper.nested) text += outcomes_of(nested, cruise);
  return text + ")";
}

}  // namespace airtruth::aircraft
