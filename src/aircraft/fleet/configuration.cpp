// SPDX-License-Identifier: Apache-2.0
#include "aircraft/fleet/configuration.h"

#include <set>

#include <fmt/format.h>

#include "aircraft/fleet/fleet.h"
#include "aircraft/wrapper/outcomes.h"
#include "aircraft/wrapper/reader.h"
#include "foundation/base/error.h"

namespace airtruth::aircraft {

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
