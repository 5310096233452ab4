// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "camera/motion/motion.h"

namespace airtruth::motion {

// The limit of a homography. One plane shows only what lies ahead of the reference camera: for
// a turn, the map of unit determinant from the frame to the reference has at a pixel the
// denominator cos(a) / cos(b), where a and b are the angles of the pixel's ray from the axes of
// reference and frame (Hartley and Zisserman, Multiple View Geometry, 13.2: H = K R K^-1). It is
// independent of the focal length. Where it is not above 0 the pixel's ray leaves the reference
// camera backward, and the plane shows it somewhere else; shortly before that a pixel of the frame
// is stretched over hundreds on the plane.
//
// A frame with such a pixel is not measured against the reference, even where its motion against
// its neighbours is known. It gets the state kTurnedAway and the motion of the last frame within
// reach.
class ReachGuard {
 public:
  ReachGuard(int width, int height) : width_(width), height_(height) {}

  // In order of time, against the first frame. A rotation has no such limit and is left as it is.
  FrameMotion next(FrameMotion motion);

 private:
  int width_;
  int height_;
  std::optional<FrameMotion> last_;
};

// The same for all frames of a clip.
std::vector<FrameMotion> within_reach(std::vector<FrameMotion> against_first,
                                      int width,
                                      int height);

}  // namespace airtruth::motion
