// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

namespace airtruth::horizon {

// What a camera sees, and the pixels without the own aircraft where a mask says so.
struct Sight {
  const image::Picture& picture;
  const lens::Lens& lens;
  const image::Mask* own_aircraft;
};

struct HorizonEdge {
  // A unit vector.
  Vector3 up_in_cam{0, -1, 0};
  // The share of the line, 0..1, across which luma steps in the same direction by a code value more
  // than the slope of the sky above explains. A slope alone is no edge, however steep it is.
  double sharpness = 0;

  // The least sharpness of a horizon. 92 % of the frames of two real flights over hills and fields
  // have more. Virtual flights have more in clear air, and 0.6 to 0.75 in haze of 13 km visibility.
  // Clear and cloudy skies without a horizon have 0.4 at most, rows of trees 0.36 to 0.65. Below it
  // the plane only separates two colours, as a coast, a bank of clouds or a sky that brightens
  // downwards do, and is no horizon.
  static constexpr double kSharp = 0.6;
  bool is_sharp() const { return sharpness >= kSharp; }
};

// Finds the plane near a first guess along which luma steps most. The picture is resampled to
// elevation over azimuth about the guess, where planes near the guess are sines. At each place the
// step that the slope of the sky explains is subtracted. The steps along each plane are summed,
// each cut off at 6 code values, so that weak steps all along count more than strong steps in a few
// places. The search is coarse first (6 degrees below the guess to 16 above) and then fine (1.5
// degrees).
HorizonEdge horizon_edge(const Sight& sight, const Vector3& guess_up_in_cam);
// The fine search alone, for a guess that is within a degree of the horizon.
HorizonEdge horizon_edge_beside(const Sight& sight, const Vector3& guess_up_in_cam);

}  // namespace airtruth::horizon
