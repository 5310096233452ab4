// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "scene/synthetic/noise.h"
#include "scene/synthetic/sky.h"

namespace airtruth::synthetic {

// Everything at infinity: sky, sun, clouds and hills. The clouds are kilometres away, and the few
// hundred metres of a flight would hardly shift them; they are drawn once, as seen from the start.
//
// The map is stereographic from the nadir: texel = centre + radius (north, east) / (1 + up). This
// one chart has no seams and covers all directions down to slightly below the horizon. Its
// resolution overhead is at least half of that at the horizon.
class Panorama {
 public:
  // `texel_rad`: the angle of a texel at the horizon.
  explicit Panorama(double texel_rad);

  // Marks a direction that frames will look at. draw() fills only the marked parts.
  void want(float north, float east, float up);
  struct Hills {
    double highest_deg = 0;
    double extinction_per_km = 0;
  };
  void draw(const Sky& sky, const Clouds& clouds, const Hills& hills, std::uint32_t seed);

  LinearRgb at(float north, float east, float up) const {
    const float scale = radius_ / (1 + up);
    const float x = centre_ + north * scale;
    const float y = centre_ + east * scale;
    const int ix = static_cast<int>(x);
    const int iy = static_cast<int>(y);
    const LinearRgb* p = &texels_[static_cast<std::size_t>(iy) * static_cast<std::size_t>(size_) +
                                  static_cast<std::size_t>(ix)];
    const float fx = x - static_cast<float>(ix);
    const float fy = y - static_cast<float>(iy);
    const LinearRgb upper = p[0] + (p[1] - p[0]) * fx;
    const LinearRgb lower = p[size_] + (p[size_ + 1] - p[size_]) * fx;
    return upper + (lower - upper) * fy;
  }
  // The component `up` of the lowest direction: a sine, 1.1 degrees below the horizon.
  static constexpr float kLowest = -0.02F;

 private:
  // Side of a part that want() marks, in texels.
  static constexpr int kBlock = 16;
  int size_ = 0;
  int blocks_ = 0;
  float radius_ = 0;
  float centre_ = 0;
  std::vector<LinearRgb> texels_;
  std::vector<std::uint8_t> wanted_;
};

}  // namespace airtruth::synthetic
