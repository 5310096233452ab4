// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "sequence/pipeline/render.h"

namespace airtruth::demo {

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
pipeline::Summary make_demo(const std::filesystem::path& out, const DemoOptions& options);

}  // namespace airtruth::demo
