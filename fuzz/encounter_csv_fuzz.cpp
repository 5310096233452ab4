// SPDX-License-Identifier: Apache-2.0
// Any bytes are encounters or an Error; what was read is written, and reads the same.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "encounter/tracks_file/formats.h"
#include "foundation/base/error.h"

namespace {

std::string written(const std::vector<airtruth::track::Encounter>& encounters) {
  std::string text = airtruth::tracks_file::encounter_csv_head();
  for (std::size_t i = 0; i < encounters.size(); ++i)
    text += airtruth::tracks_file::encounter_csv_rows(encounters[i], i + 1);
  return text;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace airtruth;
  std::vector<track::Encounter> encounters;
  try {
    encounters =
        tracks_file::parse_encounter_csv({reinterpret_cast<const char*>(data), size}, "fuzz.csv");
  } catch (const airtruth::Error&) {
    return 0;
  }
  const std::string text = written(encounters);
  try {
    if (written(tracks_file::parse_encounter_csv(text, "again.csv")) != text) std::abort();
  } catch (const airtruth::Error&) {
    // Velocities that follow from the positions may exceed the limit of a number.
  }
  return 0;
}
