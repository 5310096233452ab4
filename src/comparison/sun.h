// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "geometry/box.h"
#include "image/picture.h"
#include "scene/scene.h"

// From where the sun must shine so that an inserted aircraft is light and dark where a real one is.
namespace airtruth::comparison {

// A frame of the clip, and the real aircraft's tight box in it.
struct SunFrame {
  double time_s = 0;  // on the scene's clock
  const image::Picture* picture = nullptr;
  Box real;
};

struct SunFit {
  double azimuth_deg = 0, elevation_deg = 0;  // in the scene's world
  // Of the luma within the box, each less its surroundings, inserted less real: root mean square
  // over the frames, in code values; and of how the two correlate, -1..1.
  double difference_codes = 0;
  double correlation = 0;
};

// Paints the scene's first intruder into each frame under suns from 49 directions (every 30 degrees
// of azimuth at elevations of 10, 25, 45 and 65 degrees, and the zenith), and takes the one with
// the least difference. The scene's camera model counts as far as it is stated; a point spread that
// is not is 0.8 px. Empty where the two aircraft cannot both be seen in any frame. Throws
// Interrupted on stop.
std::optional<SunFit> fit_sun(const scene::Scene& scene,
                              const std::vector<SunFrame>& frames,
                              const std::stop_token& stop = {});

}  // namespace airtruth::comparison
