// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "foundation/base/log.h"
#include "foundation/geometry/transform.h"

// Finds the type and the attitude whose silhouette matches a real aircraft's.
namespace airtruth::match {

struct PoseFit {
  std::string aircraft;  // its type
  // The attitude as seen by a level camera that looks north, with the aircraft straight ahead.
  YawPitchRoll attitude;
  // Intersection over union of the two silhouettes, both cropped to their bounds; mean over the
  // masks, 0 to 1.
  double overlap = 0;
  // Width over height of the real silhouette, divided by the same ratio of the rendered one.
  double aspect_ratio = 1;
};

// Types of distinct appearance, one of each kind, in mostly white paint like most civil aircraft:
// aeroplanes, or helicopters. They are searched where the user states no types. One silhouette of
// a few pixels fits aircraft of both classes alike, so the class is stated and not searched.
std::vector<std::string> types_to_match(bool helicopters);

// Renders silhouettes of each type from 78 directions and searches them, mirrored and rotated in
// the picture, for the best match with the first mask. Of the three types that match it best, it
// then refines the four best matches with all masks, in steps of 8, 4 and 2 degrees. A silhouette
// is the same from the front and below as from behind and above; of two such attitudes the result
// is the one seen from below. Of attitudes that match equally well the result is the more upright
// one. The aircraft's up axis is within 60 degrees of the picture's, except where the aircraft is
// seen from more than 45 degrees below.
//
// Returns the poses that fit nearly as well as the best does, best first: two of each type at most
// and 30 degrees or more apart, with 0.95 of the best's score or more. A silhouette alone does not
// say which of them it is. `masks`: one or more tightly bounded masks, 8-bit, 255 for the aircraft.
// A type that is not in the catalogue is passed over with a warning. Error where none is left.
// Throws Interrupted on stop.
std::vector<PoseFit> fit_types(const std::vector<cv::Mat>& masks,
                               const std::vector<std::string>& types,
                               const Warn& warn,
                               const std::stop_token& stop = {});

}  // namespace airtruth::match
