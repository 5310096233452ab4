// SPDX-License-Identifier: Apache-2.0
// Any bytes are a track or an Error.
#include <cstdint>
#include <string_view>

#include "encounter/tracks_file/formats.h"
#include "foundation/base/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    airtruth::tracks_file::parse_track_csv({reinterpret_cast<const char*>(data), size}, "fuzz.csv");
  } catch (const airtruth::Error&) {
  }
  return 0;
}
