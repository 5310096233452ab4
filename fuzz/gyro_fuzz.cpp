// SPDX-License-Identifier: Apache-2.0
// Any bytes are a packet of telemetry with samples in its span of time, or without a sample.
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "camera/gyro/gyro.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr double kBegin = 2, kEnd = 3;
  double last_s = kBegin;
  for (const auto& sample : airtruth::gyro::gyro_from_gpmf({data, size}, kBegin, kEnd)) {
    if (!(sample.time_s >= last_s && sample.time_s < kEnd)) std::abort();
    if (!sample.rate_radps.allFinite()) std::abort();
    last_s = sample.time_s;
  }
  return 0;
}
