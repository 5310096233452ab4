// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "calibration/camera_file/calibrate.h"
#include "picture/composite/sensor.h"
#include "picture/video/writer.h"
#include "scene/synthetic/flight.h"

// For tests: writes virtual flights as video clips with a known camera effect, which the
// calibration must then measure.
namespace airtruth::camera_file {

// The camera effects that are applied to a flight.
struct Injected {
  double point_spread_px = 0;
  // Supersampling: one pixel of the clip is the mean of `finer` x `finer` pixels of the flight. A
  // flight renders each pixel by one ray, through textures that are softer than a pixel.
  int finer = 1;
  composite::Sensor sensor;
};

// A temporary video file, which the destructor removes.
class Clip {
 public:
  Clip();
  ~Clip();
  Clip(const Clip&) = delete;
  Clip& operator=(const Clip&) = delete;
  const fs::path& path() const { return path_; }

  // Writes the pictures of `frame` with the length, size and frame rate of `o`.
  void write(const synthetic::FlightOptions& o,
             const std::function<image::Picture(int)>& frame,
             video::Format format = video::Format::kMkv,
             int quality = 18);
  // Writes a flight, or some of its frames, with the effects of `what`. `panels`: the ground has
  // painted panels, such as those of airfields.
  void write(const synthetic::Flight& flight,
             const Injected& what,
             bool panels = false,
             int first_frame = 0,
             std::optional<int> frame_count = {});

 private:
  // The number of clips that this process has made.
  inline static int made_ = 0;
  fs::path path_;
};

// Options of a flight of 30 frames of 960 x 720 pixels, filmed with an ideal sensor.
synthetic::FlightOptions ideal(std::uint64_t seed);

// Expects that the calibration has the value `key`, and that it differs from `truth` by at most
// `share` of `truth`.
void expect_within(const Calibration& c, const std::string& key, double truth, double share);

}  // namespace airtruth::camera_file
