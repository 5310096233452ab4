// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/tone_curve.h"

// The camera's processing of its samples: sharpening and noise on luma, blur on chroma. Values are
// code values on a patch of the frame. Where the planes are red, green and blue, a change of luma
// is the same in each, and chroma is blue less luma and red less luma.
namespace airtruth::composite {

struct Sensor {
  // Unsharp mask: y + sharpening (y - G y), where G is a Gaussian of standard deviation
  // sharpening_px.
  double sharpening = 0;
  double sharpening_px = 1;
  // The noise's variance at linear light x (0..1) is noise_gain x + noise_floor (Foi et al. 2008,
  // "Practical Poissonian-Gaussian noise modeling", eq. 3). Its spatial correlation is that of
  // white noise after a Gaussian of noise_correlation_px.
  double noise_gain = 0;
  double noise_floor = 0;
  double noise_correlation_px = 0;
  image::ToneCurve tone;
  // Standard deviation of the blur of chroma beyond that of luma, in luma pixels.
  double chroma_spread_px = 0;

  bool has_noise() const { return noise_gain > 0 || noise_floor > 0; }
  // Reach of the sharpening, in pixels.
  int halo_px() const;
  // Reach of the chroma blur, in pixels.
  int chroma_px() const;
  int reach_px() const { return std::max(halo_px(), chroma_px()); }
};

// Replaces the change in a patch of the frame by change + sharpening (change - G change). The
// background is already sharpened, and sharpening is linear: a change of the background is
// therefore sharpened by itself. What the frame cuts continues beyond it as in spread().
void sharpen(std::vector<float>& change,
             const PixelBox& patch,
             const PixelBox& frame,
             const Sensor& sensor);

// Standard deviation of luma noise in code values, at a coded luma of 0..1.
float noise_sigma(float luma, float codes_per_unit, const Sensor& sensor);

// Noise of unit variance over a patch. A pixel of a frame has the same noise in every patch.
std::vector<float> noise_field(const PixelBox& patch,
                               std::uint64_t seed,
                               std::int64_t frame,
                               double correlation_px);

}  // namespace airtruth::composite
