// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "foundation/geometry/transform.h"

namespace airtruth::motion {

// The exponential and the principal logarithm of a homography of determinant 1 between pictures, by
// which maps are averaged. The logarithm is not finite where the map has none: an eigenvalue that
// is negative or 0.
//
// By scaling and squaring, and by inverse scaling and squaring with the square roots of Denman and
// Beavers (Higham 2008, "Functions of Matrices", sections 6.3, 10.3 and 11.5).
Homography exponential(const Homography& logarithm);
Homography logarithm(const Homography& map);

}  // namespace airtruth::motion
