// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "foundation/geometry/box.h"
#include "foundation/geometry/transform.h"

namespace airtruth::image {

// A soft spot in the picture: something on the lens, far out of focus, or a reflection within it.
// Its outline is a capsule, or a circle with lobes; its alpha is even inside and fades towards the
// outline. An insect has the blur of its wings across it.
//
// Example: a circle of 40 px with a softness of 0.5 and an opacity of 0.4 has an alpha of 0.4 up to
// 10 px from its centre, of 0.2 at 15 px and of 0 from 20 px on.
struct Spot {
  // Amplitudes of the cosines and sines of twice to five times the angle, as shares of the radius.
  static constexpr std::size_t kLobes = 4;

  Pixel centre = Pixel::Zero();  // at the frame's time
  Pixel velocity_px_s = Pixel::Zero();
  double radius_px = 1;
  // From the centre to the centre of each end's half circle, along `direction`.
  double half_length_px = 0;
  Pixel direction{1, 0};                    // unit
  double softness = 0;                      // 0..1: the share of the radius over which it fades
  double opacity = 1;                       // 0..1: its alpha inside
  std::array<float, 3> colour = {0, 0, 0};  // linear light
  // The blur of beating wings: a second capsule across `direction`, which fades from its middle on.
  // From the centre to a tip, 0 for none; its radius; and its alpha in the middle as a share of
  // `opacity`.
  double wing_px = 0;
  double wing_radius_px = 0;
  double wing_share = 0;
  // Of a circle alone.
  std::array<double, kLobes> cosines{};
  std::array<double, kLobes> sines{};

  // The radius in a direction, given by the cosine and sine of its angle, as a share of radius_px.
  double lobe(double cosine, double sine) const {
    double share = 1;
    double c = cosine, s = sine;
    for (std::size_t k = 0; k < kLobes; ++k) {
      const double next = c * cosine - s * sine;
      s = s * cosine + c * sine;
      c = next;
      share += cosines[k] * c + sines[k] * s;
    }
    return share;
  }
};

}  // namespace airtruth::image
