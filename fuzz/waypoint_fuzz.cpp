// SPDX-License-Identifier: Apache-2.0
// Any bytes are a waypoint file or an Error; what was read is written, and reads with the same
// counts.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "encounter/tracks_file/formats.h"
#include "foundation/base/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace airtruth;
  std::vector<track::Encounter> encounters;
  try {
    encounters =
        tracks_file::parse_waypoints({reinterpret_cast<const char*>(data), size}, "fuzz.dat");
  } catch (const airtruth::Error&) {
    return 0;
  }
  const auto aircraft = static_cast<std::uint32_t>(encounters.front().aircraft.size());
  std::string bytes =
      tracks_file::waypoint_head(static_cast<std::uint32_t>(encounters.size()), aircraft);
  for (const track::Encounter& encounter : encounters)
    bytes += tracks_file::waypoints_of(encounter, aircraft);
  try {
    if (tracks_file::parse_waypoints(bytes, "again.dat").size() != encounters.size()) std::abort();
  } catch (const airtruth::Error&) {
    // A number at the limit may exceed it after the conversion of its unit.
  }
  return 0;
}
