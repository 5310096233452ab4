// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "calibration/air/ground_seen.h"

// Measures extinction from ground that is seen again at a shorter range. The method compares each
// piece of ground only with itself.
namespace airtruth::air {

// By Koschmieder (1924), the light L_ij of square i in view j at the range r_ij, and the light L_sb
// of far ground in sector s and range band b, are
//
//   L_ij = A_s + (J_i - A_s) exp(-extinction r_ij)      L_sb = A_s + (J - A_s) exp(-extinction r_b)
//
// The fit solves for the squares' own light J_i, its mean J and the airlights A_s, which have `sky`
// at the true horizon as prior. Squares alone do not separate more air from brighter air; the sky,
// and the ground near the horizon, which is almost entirely airlight, determine the brightness of
// the airlight. The fit also solves for the contrast of the squares that is lost to the pixel size
// and to errors of the path; that loss grows with the range squared. The channels are coupled by
// the wavelength dependence of haze (Angstrom 1929: extinction is proportional to the wavelength to
// a power between 0 and -2). The results are means over the parameters that remain possible. Errors
// include a tenth of the value: that is the scatter over virtual flights, whose ground does not
// look the same from all directions. Empty if the error of the extinction is more than 0.3 of its
// value, and without any sky.
struct SeenAgain {
  ColourEstimate extinction_per_km;
  // Airlight at the horizon ahead of the camera.
  ColourEstimate airlight;
};
std::optional<SeenAgain> fading_of_same_ground(const GroundSeen& seen,
                                               const SkyCurves& sky,
                                               double altitude_m);

}  // namespace airtruth::air
