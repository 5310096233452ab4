// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "foundation/image/tone_curve.h"
#include "measure/calibration/ground_track.h"

// The light of level ground, by where it lies.
namespace airtruth::calibration {

// One square of the ground, a height wide, in one view.
struct SquareSeen {
  int square = 0;
  int sector = 0;    // of the view's azimuth (extinction.h) that it lies in
  double range = 0;  // heights
  std::array<double, 3> light{};
};

// Ground from just under the true horizon to where squares begin to be told apart: what all views
// show of a band of it in one sector, on the whole.
struct FarGround {
  int sector = 0;
  double range = 0;  // heights
  std::array<double, 3> light{};
};

struct GroundSeen {
  // In the order of their squares. As far out as a pixel's way along the ground stays within one.
  std::vector<SquareSeen> squares;
  std::vector<FarGround> far;
};
GroundSeen ground_seen(const std::vector<GroundView>& views,
                       const GroundTrack& track,
                       const lens::Lens& lens,
                       const image::Mask* own_aircraft,
                       const image::ToneCurve& tone);

}  // namespace airtruth::calibration
