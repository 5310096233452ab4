// SPDX-License-Identifier: Apache-2.0
// Any bytes are a table of states or an Error; what was read is finite, and it is written as both
// kinds and read again.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "encounter/tracks_file/formats.h"
#include "foundation/base/error.h"

namespace {

using namespace airtruth;

void check_tracks(const track::Encounter& encounter) {
  for (const track::Track& track : encounter.aircraft)
    for (std::size_t i = 0; i < track.size(); ++i)
      if (!track.positions_ned_m[i].allFinite() || !track.velocities_ned_mps[i].allFinite())
        std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  track::Encounter encounter;
  try {
    encounter = tracks_file::parse_state_table(text, "fuzz.daa");
  } catch (const airtruth::Error&) {
    return 0;
  }
  check_tracks(encounter);
  for (const bool is_daa : {true, false}) {
    try {
      const track::Encounter again = tracks_file::parse_state_table(
          is_daa ? tracks_file::daa_of(encounter) : tracks_file::state_table_of(encounter),
          "again");
      if (again.aircraft.size() != encounter.aircraft.size()) std::abort();
    } catch (const airtruth::Error&) {
      // Numbers near the limit exceed it in another unit.
    }
  }
  return 0;
}
