// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "foundation/base/files.h"
#include "scene/synthetic/flight.h"
#include "sequence/demo/demo.h"

// For tests: a small video without the own aircraft in view.
namespace airtruth::test_support {

inline void write_flight(const fs::path& file, int width, int height, int frames) {
  synthetic::FlightOptions flight;
  flight.seed = 5;
  flight.width = width;
  flight.height = height;
  flight.frame_count = frames;
  flight.own_aircraft = false;
  demo::write_flight(synthetic::Flight(flight), file, {});
}

}  // namespace airtruth::test_support
