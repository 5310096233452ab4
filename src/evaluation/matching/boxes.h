// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <airtruth/metrics.h>

#include "camera/lens/lens.h"
#include "foundation/geometry/box.h"

// Where an answer lies beside the truth: their centres, the angle between them, and whether they
// are near enough to be of one aircraft. The overlap of two boxes is evaluation::overlap
// (<airtruth/metrics.h>).
//
// An aircraft of 6 px has an overlap below 0.5 with a box that lies 2 px beside it, so detections
// are matched by distance: the centre of a detection may be max(centre_px, half of the aircraft's
// longer side) away from that of the aircraft.
//
// Example: centre_px = 10, and an aircraft of 6 x 3 px is at (100, 100). A detection with its
// centre at (108, 106) matches it; one at (111, 100) does not. Of an aircraft of 60 x 20 px a
// detection may be 30 px away.
namespace airtruth::matching {

// Distance between the centres of two boxes.
double centre_distance_px(const Box& a, const Box& b);
// The largest distance from the centre of this aircraft to that of a detection that matches it.
double match_radius_px(const Box& truth_px, double centre_px);
bool centre_is_in(const Box& detection_px, const Box& region_px);

// Angle between the rays through the centres of two boxes, in milliradians; empty where the lens
// has no ray at one of them.
std::optional<double> angle_mrad(const lens::Lens& lens, const Box& a, const Box& b);

}  // namespace airtruth::matching
