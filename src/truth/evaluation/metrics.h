// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <airtruth/metrics.h>

#include "camera/lens/lens.h"
#include "foundation/geometry/box.h"

// The measures of <airtruth/metrics.h> that need a position or a lens.
namespace airtruth::evaluation {

Pixel centre_of(const Box& box);

// Angle between the rays through the centres of two boxes, in milliradians; empty where the lens
// has no ray at one of them.
std::optional<double> angle_mrad(const lens::Lens& lens, const Box& a, const Box& b);

}  // namespace airtruth::evaluation
