// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calibration/extinction.h"
#include "calibration/ground_track.h"
#include "image/tone_curve.h"

// Extinction from ground that is seen again from nearer: no ground has to be like other ground.
namespace airtruth::calibration {

// The light of one square of the ground, a height wide, in one view.
struct GroundSeen {
  int square = 0;
  double range = 0;  // heights
  std::array<double, 3> light{};
};

// In the order of their squares. As far out as a pixel's way along the ground stays within one.
std::vector<GroundSeen> ground_seen(const std::vector<GroundView>& views,
                                    const GroundTrack& track,
                                    const lens::Lens& lens,
                                    const image::Mask* own_aircraft,
                                    const image::ToneCurve& tone);

// By Koschmieder (1924), of each square i in each view j,
//
//   L_ij = A + (J_i - A) exp(-extinction r_ij)
//
// with the squares' own light J and the airlight A (held near `airlight`, the sky's at the horizon)
// solved for. Channels are held together by what haze does (Angstrom 1929: extinction goes with
// the wavelength to a power of 0 to -2): alone, red and blue trade airlight for extinction the
// opposite ways. Means over what is left possible. Errors have a tenth of the value in them: so
// much do virtual flights scatter, whose ground does not look the same from everywhere. Empty where
// extinction is known to less than a third of its value.
struct SeenAgain {
  ColourEstimate extinction_per_km;
  ColourEstimate airlight;  // at the horizon, ahead
};
std::optional<SeenAgain> fading_of_same_ground(const std::vector<GroundSeen>& seen,
                                               const ColourEstimate& airlight,
                                               double altitude_m);

}  // namespace airtruth::calibration
