// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "calibration/air/ground_track.h"
#include "calibration/air/sky_curve.h"
#include "camera/lens/lens.h"
#include "foundation/image/layer.h"
#include "foundation/image/tone_curve.h"

// The light of level ground by its position on the ground. Lengths are in heights: multiples of the
// camera's height above the ground.
namespace airtruth::air {

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
GroundSeen ground_seen(const Scenery& scenery,
                       const GroundTrack& track,
                       const image::ToneCurve& tone);

// The light of level ground, averaged over patches of equal size on the ground at any distance.
// Without that, far ground would look more uniform than near ground because a far pixel covers
// more of it. A patch is as large as the ground that one pixel covers at 2 degrees below the
// horizon; farther away a patch is one pixel. The patches of all views follow one another in the
// order of the views.
std::vector<SeenLight> ground_patches(const Scenery& scenery,
                                      double altitude_m,
                                      const image::ToneCurve& tone);

// The direction in which a pixel of a lens looks.
struct PixelRay {
  int x = 0, y = 0;
  Vector3 in_cam;
};

// The rays of a grid of pixels, row by row. The grid begins at pixel `first` in both directions and
// has a spacing of `step` pixels. Pixels of the own aircraft (nullptr: there is no mask) and pixels
// outside the image circle of the lens are left out. The rays are the same for all pictures of a
// clip.
std::vector<PixelRay> pixel_rays(const lens::Lens& lens,
                                 const image::Mask* own_aircraft,
                                 int first,
                                 int step);

}  // namespace airtruth::air
