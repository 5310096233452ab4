// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace airtruth::video {

// A packet of a GoPro's telemetry track ("gpmd"), undecoded.
struct TelemetryPacket {
  // Seconds from the first frame of the video.
  double begin_s = 0;
  double end_s = 0;
  std::vector<std::uint8_t> bytes;
};

// All packets of the file, in their order; empty where the file has no such track. Error where the
// file cannot be read.
std::vector<TelemetryPacket> read_telemetry(const std::filesystem::path& path);

}  // namespace airtruth::video
