// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "aircraft/model/mesh.h"
#include "foundation/base/log.h"
#include "foundation/geometry/transform.h"

// Which attitude, and which type, has the silhouette that a real aircraft shows.
namespace airtruth::comparison {

struct PoseFit {
  // As a camera that looks north, level, sees the aircraft straight ahead.
  YawPitchRoll attitude;
  // Intersection over union of the two silhouettes, mean over the masks, both bounded alike; 0..1.
  double overlap = 0;
  // The real one's width over its height, over that of the render.
  double aspect_ratio = 1;
};

// Renders silhouettes of the mesh from 78 directions and searches them, mirrored and turned in the
// picture, for the one that fits the first mask; then closes in on the four best, by
// all masks, in steps of 8, 4 and 2 degrees. A
// silhouette is the same from the front and below as from behind and above: of two such attitudes
// the one that is seen from below is given. Of attitudes that fit alike
// the more upright one is given. The aircraft's up is within 60 degrees of the
// picture's, except where it is seen from more than 45 degrees below. `masks`: 8-bit, 255:
// aircraft, bounded tightly; one or more. Throws Interrupted on stop.
PoseFit fit_pose(const std::vector<cv::Mat>& masks,
                 const aircraft::Mesh& mesh,
                 const std::stop_token& stop = {});

// Types that look unlike one another, one of each kind, in mostly white paint as most civil
// aircraft are: what is searched where nothing is stated.
std::vector<std::string> types_to_match();

struct TypeFit {
  std::string aircraft;
  PoseFit pose;
};

// Of several types, the poses that fit nearly as well as the best does, best first: those of
// fit_pose() for the three types whose coarse silhouettes fit best, two of each at most and 30
// degrees or more apart, with 0.95 of the best's score or more. A silhouette alone does not say
// which of them it is. A type that is not in the catalogue is passed over with a warning. Error
// where none is left.
std::vector<TypeFit> fit_types(const std::vector<cv::Mat>& masks,
                               const std::vector<std::string>& types,
                               const Warn& warn,
                               const std::stop_token& stop = {});

}  // namespace airtruth::comparison
