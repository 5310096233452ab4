// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "scene/synthetic/noise.h"
#include "scene/synthetic/rays.h"

namespace airtruth::synthetic {

// Mottled discs that move over the image independently of the camera: motion that a motion estimate
// must reject.
class Clutter {
 public:
  Clutter(int width, int height, double share, std::uint32_t seed);

  struct Disc {
    float x = 0;
    float y = 0;
    float radius = 0;
    std::uint32_t seed = 0;
  };
  std::vector<Disc> at(double time_s) const;
  // Draws the discs over a row of light.
  static void draw(const std::vector<Disc>& discs, int y, int width, LightRow& row);

 private:
  int width_;
  int height_;
  float radius_ = 0;
  int count_ = 0;
  std::uint32_t seed_;
};

}  // namespace airtruth::synthetic
