// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>

#include "foundation/base/files.h"
#include "picture/video/writer.h"
#include "scene/synthetic/flight.h"
#include "sequence/pipeline/render.h"

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

struct DemoOptions {
  std::uint64_t seed = 1;
  int frame_count = 322;
  // Of the run; its progress also tells of the flight and the overlay.
  pipeline::Options run;
};

// Makes <out>/ from this program and the installed aircraft alone: flight.mp4 (a virtual flight),
// flight.csv (its true camera), own_aircraft.png (its mask), demo.toml (the scene, a starting point
// for the user's own), demo/ (the sequence) and overlay.mp4. Throws Error where <out>/demo exists
// and overwrite is false.
pipeline::Summary make_demo(const fs::path& out, const DemoOptions& options);

}  // namespace airtruth::demo
