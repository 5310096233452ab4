// SPDX-License-Identifier: Apache-2.0
#include "dataset/sequences/condition.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/names.h"
#include "foundation/base/text.h"
#include "scene/scene/camera_keys.h"

namespace airtruth::sequences {
namespace {

double bound_from(const std::string& text, double otherwise) {
  return text.empty() ? otherwise : finite_number(text, {"--where"});
}

}  // namespace

Condition condition_from(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::size_t dots = text.find("..", equals == std::string::npos ? text.size() : equals);
  if (dots == std::string::npos || text.size() == equals + 3)
    throw Error(fmt::format("is '{}'; expected KEY=LOW..HIGH, as in noise=1..2", text),
                {"--where"});
  Condition condition{text, text.substr(0, equals), 0, 0};
  const std::vector<std::string> known = scene::weather_names();
  if (std::find(known.begin(), known.end(), condition.key) == known.end())
    throw Error(fmt::format("has the key '{}'{}; expected {}",
                            condition.key,
                            did_you_mean(condition.key, known),
                            fmt::join(known, ", ")),
                {"--where"});
  constexpr double kOpen = std::numeric_limits<double>::infinity();
  condition.low = bound_from(text.substr(equals + 1, dots - equals - 1), -kOpen);
  condition.high = bound_from(text.substr(dots + 2), kOpen);
  if (condition.low > condition.high)
    throw Error(fmt::format("is '{}', which falls; expected LOW..HIGH", text), {"--where"});
  return condition;
}

bool hold(const std::vector<Condition>& conditions, const std::map<std::string, double>& facts) {
  return std::all_of(conditions.begin(), conditions.end(), [&](const Condition& condition) {
    const auto fact = facts.find(condition.key);
    return fact != facts.end() && fact->second >= condition.low && fact->second <= condition.high;
  });
}

}  // namespace airtruth::sequences
