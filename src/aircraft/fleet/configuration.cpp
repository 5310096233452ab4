// SPDX-License-Identifier: Apache-2.0
#include "aircraft/fleet/configuration.h"

#include <set>

#include <fmt/format.h>

#include "aircraft/fleet/fleet.h"
#include "aircraft/wrapper/reader.h"
#include "aircraft/wrapper/wrapper.h"
#include "foundation/base/error.h"

namespace airtruth::aircraft {
namespace {

// All that a wrapper derives from the state at cruise, as text: whether each condition holds, and
// the value of each animation. Two states with the same outcomes give the same model.
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

}  // namespace

std::string configuration_of(const std::string& name, const LoadOptions& options) {
  if (is_model_file(name) && ending_of(name) != ".xml") return {};
  const std::string state = fmt::format("{:a} {:a}", options.airspeed_kt, options.altitude_agl_ft);
  if (is_model_file(name)) return state;
  try {
    const Entry entry = find_aircraft(name);
    if (entry.catalogue_folder != fs::path(kDebianAircraft)) return state;
    const fs::path root = data_root_of(entry.catalogue_folder);
    DiskFiles files(root, {});
    std::set<std::string> missing;
    const Wrapper wrapper =
        read_wrapper(files, fs::absolute(entry.file).lexically_relative(root), missing);
    return outcomes_of(wrapper, {options.airspeed_kt, options.altitude_agl_ft});
  } catch (const Error&) {
    return state;  // load_aircraft() reports it
  }
}

}  // namespace airtruth::aircraft
