// SPDX-License-Identifier: Apache-2.0
// Any bytes are an encounter model or an Error; what was read gives finite tracks or an Error.
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "encounter/encounter_model/sampler.h"
#include "foundation/base/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace airtruth;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    encounter_model::SampleOptions options;
    options.duration_s = 5;
    const encounter_model::Sampler sampler(encounter_model::parse_model(text, "fuzz.txt"), options);
    for (std::uint64_t i = 0; i < 2; ++i)
      for (const airtruth::Vector3& position : sampler.sample(i).track.positions_ned_m)
        if (!position.allFinite()) std::abort();
  } catch (const airtruth::Error&) {
  }
  return 0;
}
