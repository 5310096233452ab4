// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "foundation/base/seed.h"
#include "foundation/image/picture.h"

// A picture as another camera than its own shows it, for detectors of cameras that are not known
// when they are trained. Tobin et al. 2017, "Domain randomization for transferring deep neural
// networks from simulation to the real world", draw the camera of each picture anew.
namespace airtruth::stream {

// What the camera adds to a picture, in this order. The defaults add nothing; codes beyond the
// nominal range end at it.
struct OtherCamera {
  double spread_px = 0;  // standard deviation of a Gaussian
  // Coded luma v of 0..1 becomes gain v^gamma, clipped at 1.
  double gamma = 1;
  double gain = 1;
  // Standard deviation of the noise of luma at half the range, in shares of the range; its variance
  // grows with the luma. Its spatial correlation is that of white noise after a Gaussian of
  // noise_correlation_px. Red, green and blue have the same noise.
  double noise = 0;
  double noise_correlation_px = 0;
  // Unsharp mask: v + sharpening (v - G v), where G is a Gaussian of one pixel.
  double sharpening = 0;
  // Chroma about grey is multiplied by `saturation` after a Gaussian of chroma_spread_px, in pixels
  // of luma; then `tint` is added to Cb and Cr, in code values. RGB keeps its colours.
  double saturation = 1;
  double chroma_spread_px = 0;
  std::array<double, 2> tint{};
  int quantiser = 0;  // of an H.264 encoder, as video::PatchCodec; 0: none
};

OtherCamera drawn_camera(Random random);

// `seed`: of the noise. A picture whose Colour the encoder cannot code is not coded; of an odd
// side the last column or row is not.
image::Picture seen_through(const OtherCamera& camera,
                            const image::Picture& picture,
                            std::uint64_t seed);

}  // namespace airtruth::stream
