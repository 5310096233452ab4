// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"
#include "world/scene/scene.h"

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
  // Of red, green and blue within the box, each less its surroundings, in code values over all
  // frames: the root of half the mean square of inserted less real where both are blurred by a
  // twelfth of the box (poses fit no better), and half that of their values sorted (how much is how
  // bright); and how the blurred two correlate, -1..1.
  double difference_codes = 0;
  double correlation = 0;
};

// Paints the scene's first intruder into each frame under suns all over the sky, `spacing_deg` of
// azimuth and two thirds of that in elevation apart (from 10 degrees above the horizon on), closes
// in on the best three by a half and a quarter of the spacing, and takes the one with the least
// difference. A sun that brightens one side and one that brightens the whole can look alike, so
// that the best of a wide spacing may be far from the best of all: 40 degrees serve to compare
// poses and liveries, 15 to find the sun. The scene's camera model counts as far as it is stated; a
// point spread that is not is 0.8 px. Frames are drawn in draft quality. Empty where the two
// aircraft cannot both be seen in any frame. Throws Interrupted on stop.
std::optional<SunFit> fit_sun(const scene::Scene& scene,
                              const std::vector<SunFrame>& frames,
                              double spacing_deg,
                              const std::stop_token& stop = {});

}  // namespace airtruth::comparison
