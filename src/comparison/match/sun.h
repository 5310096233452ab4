// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"
#include "scene/scene/scene.h"

// Finds the sun's direction for which the light and dark parts of an inserted aircraft lie where a
// real aircraft has them.
namespace airtruth::match {

// A frame of the clip, and the real aircraft's tight box in it.
struct SunFrame {
  double time_s = 0;  // on the scene's clock
  const image::Picture* picture = nullptr;
  Box real;
};

struct SunFit {
  double azimuth_deg = 0, elevation_deg = 0;  // in the scene's world
  // Both compare red, green and blue within the box, each relative to its surroundings, over all
  // frames. difference_codes, in code values, is the root of the mean of two mean squares of
  // inserted minus real: where both are blurred by a twelfth of the box (poses are not more
  // accurate), and between their sorted values (the distribution of brightness). correlation is
  // that of the two blurred pictures, -1 to 1.
  double difference_codes = 0;
  double correlation = 0;
};

// Renders the scene's first intruder into each frame under suns all over the sky from 10 degrees
// above the horizon, `spacing_deg` apart in azimuth and two thirds of that in elevation. The search
// then refines the best three at a half and a quarter of the spacing, and returns the sun with the
// smallest difference. A sun that brightens one side and a sun that brightens the whole aircraft
// can look alike, so the best sun of a wide spacing may be far from the true optimum: 40 degrees
// suffice to compare poses and liveries, 15 degrees to find the sun. The scene's camera model is
// used as far as it is stated; an unstated point spread is 0.8 px. Frames are rendered in draft
// quality. Returns empty where no frame shows both aircraft. Throws Interrupted on stop.
std::optional<SunFit> fit_sun(const scene::Scene& scene,
                              const std::vector<SunFrame>& frames,
                              double spacing_deg,
                              const std::stop_token& stop = {});

}  // namespace airtruth::match
