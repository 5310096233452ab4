// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace airtruth::calibration {

// A straight edge in luma, in pixels with integer centres.
struct EdgeLine {
  double x = 0, y = 0;    // a point on the edge
  double nx = 0, ny = 0;  // unit vector across the edge
  double half_length_px = 0;
};

}  // namespace airtruth::calibration
