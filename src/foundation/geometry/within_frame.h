// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include "foundation/base/names.h"
#include "foundation/geometry/transform.h"

// The time within one frame: when each pixel is exposed, and how poses change meanwhile. A time
// dt_s is in seconds from the frame's own time, which is the middle of the exposure of the sensor's
// middle row (or column).
namespace airtruth {

// The motion of a pose, which is uniform over the short time of a frame: the velocity of its origin
// and the rate of rotation about its origin, both in world axes.
struct Twist {
  Vector3 velocity_mps = Vector3::Zero();
  Vector3 rate_radps = Vector3::Zero();
};

// The rotation by a rotation vector (radians).
Quaternion rotation_from_vector(const Vector3& vector_rad);
// The rotation vector (radians) of a rotation, by the shorter of the two turns.
Vector3 vector_from_rotation(const Quaternion& rotation);

// The pose after dt_s.
Rigid carried(const Rigid& world_from_x, const Twist& twist, double dt_s);

// The direction in which the sensor reads its rows (columns).
enum class Readout { kDown, kUp, kRight, kLeft };

constexpr auto enum_names(Readout) {
  return std::to_array<EnumName<Readout>>({{Readout::kDown, "down"},
                                           {Readout::kUp, "up"},
                                           {Readout::kRight, "right"},
                                           {Readout::kLeft, "left"}});
}

struct Shutter {
  double exposure_s = 0;
  // The time from the first row to the last; 0 is a global shutter.
  double readout_s = 0;
  Readout readout = Readout::kDown;

  bool is_instant() const { return exposure_s <= 0 && readout_s <= 0; }
  // The middle of the exposure of the row (column) of a pixel. All points of a pixel have the time
  // of its centre line: `pixel` is rounded to floor + 0.5.
  double middle_s(const Pixel& pixel, int width, int height) const;
  // When a moving point's own row (column) is exposed, by fixed-point iteration: `pixel_at(dt_s)`
  // is its pixel, or std::nullopt where none shows it, and then the time is 0. Each round
  // multiplies the error by the share of the image that the point crosses during a readout.
  template <typename PixelAt>
  double seen_s(const PixelAt& pixel_at, int width, int height, int rounds) const {
    double dt_s = 0;
    for (int round = 0; readout_s > 0 && round < rounds; ++round) {
      const std::optional<Pixel> pixel = pixel_at(dt_s);
      if (!pixel) return 0;
      const Pixel inside(std::clamp(pixel->x(), 0.0, double(width)),
                         std::clamp(pixel->y(), 0.0, double(height)));
      dt_s = middle_s(inside, width, height);
    }
    return dt_s;
  }
  // Where a point that moves evenly from `at`, its place at the frame's time, is when its own row
  // sees it.
  Pixel seen_at(const Pixel& at, const Pixel& velocity_px_s, int width, int height) const {
    constexpr int kRounds = 6;
    if (velocity_px_s.isZero(0)) return at;
    const auto place = [&](double dt_s) -> Pixel { return at + dt_s * velocity_px_s; };
    return place(seen_s(place, width, height, kRounds));
  }
};

// The measured shake of the camera in a frame and its change per second, in one of the two models
// of camera/motion/motion.h.
struct Shake {
  Homography frame_from_reference = Homography::Identity();
  Homography frame_from_reference_per_s = Homography::Zero();
  // cam_from_nominal_cam.
  std::optional<Quaternion> rotation;
  // The rate of that rotation, in the axes of cam.
  Vector3 rate_radps = Vector3::Zero();

  Quaternion rotation_at(double dt_s) const {
    return rotation ? rotation_from_vector(dt_s * rate_radps) * *rotation : Quaternion::Identity();
  }
};

}  // namespace airtruth
