// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "calibration/air/ground_track.h"
#include "camera/lens/lens.h"
#include "foundation/image/layer.h"
#include "foundation/image/tone_curve.h"

// The light of level ground by its position on the ground. Lengths are in heights: multiples of the
// camera's height above the ground.
namespace airtruth::calibration {

// One square of the ground, one height wide, as one view shows it.
struct SquareSeen {
  // Number of the square; equal numbers in different views mean the same ground.
  int square = 0;
  // Sector of the azimuth (extinction.h) at which the view shows the square.
  int sector = 0;
  // Range from the camera, heights.
  double range = 0;
  // Linear light: red, green, blue.
  std::array<double, 3> light{};
};

// Ground between the true horizon and the distance at which single squares can be resolved: the
// mean light of one range band in one sector over all views.
struct FarGround {
  int sector = 0;
  double range = 0;  // heights
  std::array<double, 3> light{};
};

struct GroundSeen {
  // Sorted by square. They reach as far as the ground that one pixel covers stays within one
  // square.
  std::vector<SquareSeen> squares;
  std::vector<FarGround> far;
};
// `track` gives the position and the level frame of each view.
GroundSeen ground_seen(const std::vector<GroundView>& views,
                       const GroundTrack& track,
                       const lens::Lens& lens,
                       const image::Mask* own_aircraft,
                       const image::ToneCurve& tone);

}  // namespace airtruth::calibration
