// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/reach.h"

#include <cmath>
#include <utility>

namespace airtruth::motion {
namespace {

// cos(85 degrees), chosen: there a pixel of the frame covers 1 / cos^2 = 130 times its length on
// the plane, so that the plane holds no detail.
constexpr double kMinDepthRatio = 0.0872;

bool is_within_reach(const Homography& frame_from_reference, int width, int height) {
  const double determinant = frame_from_reference.determinant();
  if (!frame_from_reference.allFinite() || determinant == 0) return false;
  // The cube root keeps the sign. H and -H are the same map, and the result has a positive
  // determinant.
  const Homography reference_from_frame = (frame_from_reference / std::cbrt(determinant)).inverse();
  if (!reference_from_frame.allFinite()) return false;
  // The denominator is linear in the pixel, so that its least value is at a corner.
  for (const Pixel& corner :
       {Pixel(0, 0), Pixel(width, 0), Pixel(0, height), Pixel(width, height)}) {
    const Vector3 in_reference = reference_from_frame * Vector3(corner.x(), corner.y(), 1);
    if (!(in_reference.z() > kMinDepthRatio)) return false;
  }
  return true;
}

}  // namespace

FrameMotion ReachGuard::next(FrameMotion motion) {
  if (motion.rotation) return motion;
  if (is_within_reach(motion.frame_from_reference, width_, height_)) {
    last_ = motion;
    return motion;
  }
  motion.frame_from_reference =
      last_ ? last_->frame_from_reference : Homography(Homography::Identity());
  motion.state = State::kTurnedAway;
  motion.inliers = 0;
  motion.rms_px = 0;
  return motion;
}

std::vector<FrameMotion> within_reach(std::vector<FrameMotion> against_first,
                                      int width,
                                      int height) {
  ReachGuard guard(width, height);
  for (FrameMotion& motion : against_first) motion = guard.next(std::move(motion));
  return against_first;
}

}  // namespace airtruth::motion
