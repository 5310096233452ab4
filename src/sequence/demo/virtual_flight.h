// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>

#include "foundation/base/files.h"
#include "picture/video/writer.h"
#include "scene/synthetic/flight.h"

namespace airtruth::demo {

struct VirtualFlightOptions {
  video::Format format = video::Format::kMp4;
  int quality = 23;  // the codec of a cheap camera
  std::stop_token stop;
  std::function<void(std::int64_t done, std::int64_t total)> progress;
};

// Encodes a virtual flight as a video, frames made in parallel and written in order. Throws
// Interrupted on stop.
void write_flight(const synthetic::Flight& flight,
                  const fs::path& out,
                  const VirtualFlightOptions& options);

}  // namespace airtruth::demo
