// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "measure/calibration/calibration.h"
#include "picture/composite/sensor.h"
#include "picture/video/writer.h"
#include "world/synthetic/flight.h"

// For tests: virtual flights as clips, with something in them that is to be measured out again.
namespace airtruth::calibration {

struct Injected {
  double point_spread_px = 0;
  // So many of the flight's pixels, a side, are one of the clip's: a flight draws each by one ray,
  // through textures that are softer than a pixel.
  int finer = 1;
  composite::Sensor sensor;
};

// Its file is removed with it.
class Clip {
 public:
  Clip();
  ~Clip();
  Clip(const Clip&) = delete;
  Clip& operator=(const Clip&) = delete;
  const fs::path& path() const { return path_; }

  // As long, as large and as fast as `o` says.
  void write(const synthetic::FlightOptions& o,
             const std::function<image::Picture(int)>& frame,
             video::Format format = video::Format::kMkv,
             int quality = 18);
  // A flight, or some of its frames, with that put into it; over painted panels, as airfields have
  // them.
  void write(const synthetic::Flight& flight,
             const Injected& what,
             bool panels = false,
             int first_frame = 0,
             std::optional<int> frame_count = {});

 private:
  inline static int made_ = 0;  // by this process
  fs::path path_;
};

// 30 frames of 960 x 720, through an ideal sensor.
synthetic::FlightOptions ideal(std::uint64_t seed);

// `share`: of the truth, by which the value may be off.
void expect_within(const Calibration& c, const std::string& key, double truth, double share);

}  // namespace airtruth::calibration
