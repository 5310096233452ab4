// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "foundation/geometry/transform.h"

// What happens while one frame is taken: when each pixel sees, and how poses go on meanwhile.
// Times dt_s are seconds from the frame's own time, which is the middle of the exposure of the
// sensor's middle row (or column).
namespace airtruth {

// A pose's motion, even over the short time of a frame: velocity of its origin, and turning about
// it, both in world axes.
struct Twist {
  Vector3 velocity_mps = Vector3::Zero();
  Vector3 rate_radps = Vector3::Zero();
};

// The rotation by a rotation vector (radians).
Quaternion rotation_from_vector(const Vector3& vector_rad);
// The inverse; the shorter way round.
Vector3 vector_from_rotation(const Quaternion& rotation);

// Where the pose is after dt_s.
Rigid carried(const Rigid& world_from_x, const Twist& twist, double dt_s);

enum class Readout { kDown, kUp, kRight, kLeft };  // which way the rows (columns) are read

struct Shutter {
  double exposure_s = 0;
  double readout_s = 0;  // from the first row to the last; 0: a global shutter
  Readout readout = Readout::kDown;

  bool is_instant() const { return exposure_s <= 0 && readout_s <= 0; }
  // Middle of the exposure of the row (column) that the pixel lies in. All of a pixel has one time:
  // that of its own centre line, so `pixel` is taken at floor + 0.5.
  double middle_s(const Pixel& pixel, int width, int height) const;
};

// The measured shake of the camera in a frame and its change per second; by one of two models
// (camera/motion/motion.h).
struct Shake {
  Homography frame_from_reference = Homography::Identity();
  Homography frame_from_reference_per_s = Homography::Zero();
  std::optional<Quaternion> rotation;    // cam_from_nominal_cam
  Vector3 rate_radps = Vector3::Zero();  // of that rotation, in cam's axes

  Homography homography_at(double dt_s) const {
    return frame_from_reference + dt_s * frame_from_reference_per_s;
  }
  Quaternion rotation_at(double dt_s) const {
    return rotation ? rotation_from_vector(dt_s * rate_radps) * *rotation : Quaternion::Identity();
  }
};

}  // namespace airtruth
