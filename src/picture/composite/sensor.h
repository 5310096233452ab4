// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/tone_curve.h"

// What a camera does to its samples after the light has come: sharpening and noise, on luma;
// softness, on chroma. In code values, on a patch of the frame.
namespace airtruth::composite {

struct Sensor {
  // Unsharp mask: y + sharpening (y - G y), G a Gaussian of sharpening_px.
  double sharpening = 0;
  double sharpening_px = 1;
  // Variance of linear light x (0..1): noise_gain x + noise_floor (Foi et al. 2008, "Practical
  // Poissonian-Gaussian noise modeling", eq. 3), with the spatial correlation of white noise under
  // a Gaussian of noise_correlation_px.
  double noise_gain = 0;
  double noise_floor = 0;
  double noise_correlation_px = 0;
  image::ToneCurve tone;
  // Standard deviation of a Gaussian that chroma goes through beyond what luma does, in luma
  // pixels.
  double chroma_spread_px = 0;

  bool has_noise() const { return noise_gain > 0 || noise_floor > 0; }
  int halo_px() const;    // how far sharpening reaches
  int chroma_px() const;  // how far soft chroma reaches
  int reach_px() const { return std::max(halo_px(), chroma_px()); }
};

// change + sharpening (change - G change). Sharpening is linear, and the background has been
// sharpened already: what is put over it changes by this.
void sharpen(std::vector<float>& change, int width, int height, const Sensor& sensor);

// Standard deviation of luma in code values at a luma of 0..1 (coded).
float noise_sigma(float luma, float codes_per_unit, const Sensor& sensor);

// Unit noise over a patch, the same for a pixel of a frame whatever the patch.
std::vector<float> noise_field(const PixelBox& patch,
                               std::uint64_t seed,
                               std::int64_t frame,
                               double correlation_px);

}  // namespace airtruth::composite
