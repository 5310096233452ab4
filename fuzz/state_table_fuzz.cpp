// SPDX-License-Identifier: Apache-2.0
// Any bytes are a table of states or an Error; what was read is finite, and it is written as both
// kinds and read again.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "encounter/tracks_file/state_table.h"
#include "foundation/base/error.h"

namespace {

using namespace airtruth::encounter;

void check_tracks(const Encounter& encounter) {
  for (const Track& track : encounter.aircraft)
    for (std::size_t i = 0; i < track.size(); ++i)
      if (!track.positions_ned_m[i].allFinite() || !track.velocities_ned_mps[i].allFinite())
        std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  Encounter encounter;
  try {
    encounter = parse_state_table(text, "fuzz.daa");
  } catch (const airtruth::Error&) {
    return 0;
  }
  check_tracks(encounter);
  for (const bool is_daa : {true, false}) {
    try {
      const Encounter again =
          parse_state_table(is_daa ? daa_of(encounter) : state_table_of(encounter), "again");
      if (again.aircraft.size() != encounter.aircraft.size()) std::abort();
    } catch (const airtruth::Error&) {
      // Numbers near the limit exceed it in another unit.
    }
  }
  return 0;
}
