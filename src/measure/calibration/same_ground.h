// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "measure/calibration/extinction.h"
#include "measure/calibration/ground_seen.h"

// Extinction from ground that is seen again from nearer: no ground has to be like other ground.
namespace airtruth::calibration {

// By Koschmieder (1924), of each square i in each view j, and of far ground in each sector s and
// band b,
//
//   L_ij = A_s + (J_i - A_s) exp(-extinction r_ij)      L_sb = A_s + (J - A_s) exp(-extinction r_b)
//
// with the squares' own light J_i, its mean J, and the airlights A (held near `sky`, at the true
// horizon) solved for. Squares alone cannot tell more air from brighter air: the sky, and the
// ground near the horizon, which has all but become airlight, tell how bright it is. What pixels
// and errors of the way take from the squares' contrast (by the range squared) is solved for too.
// Channels are held together by what haze does (Angstrom 1929: extinction goes with the wavelength
// to a power of 0 to -2). Means over what is left possible. Errors have a tenth of the value in
// them: so much do virtual flights scatter, whose ground does not look the same from everywhere.
// Empty where extinction is known to less than a third of its value, and without any sky.
struct SeenAgain {
  ColourEstimate extinction_per_km;
  ColourEstimate airlight;  // at the horizon, ahead
};
std::optional<SeenAgain> fading_of_same_ground(const GroundSeen& seen,
                                               const SkyCurves& sky,
                                               double altitude_m);

}  // namespace airtruth::calibration
