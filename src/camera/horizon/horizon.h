// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "camera/horizon/horizon_edge.h"
#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

namespace airtruth::horizon {

// Finds the horizon in one picture. Sky and ground are the two sides of a plane through the camera,
// so the horizon may be a curve in the picture of a wide lens. find() first takes the plane that
// separates the colours of the picture best: the method of Ettinger et al. 2002 ("Vision-guided
// flight stability and control for micro air vehicles"), with Fisher's criterion in place of their
// determinants and planes in place of their lines. In haze that plane lies below the horizon,
// within the ground. It is therefore moved to the line near it where luma steps most evenly
// (horizon_edge.h).
//
// Example: a level pinhole of 640 x 480 pixels with a vertical field of view of 60 degrees is
// pitched up by 5 degrees. The horizon crosses the middle column at y = 240 + 240 / tan(30 deg)
// tan(5 deg) = 276.4 px, and find() gives the up direction (0, -cos 5 deg, sin 5 deg) in cam.
class HorizonFinder {
 public:
  HorizonFinder(const lens::Lens& lens, const image::Mask* own_aircraft);

  // The result is empty where no plane separates the picture clearly (by 2.2 standard deviations),
  // or where less than 6 % of the picture lies on one side of the best plane.
  std::optional<HorizonEdge> find(const image::Picture& picture) const;
  // Searches within 1.5 degrees of an expected direction only, which takes a twentieth of the time.
  HorizonEdge follow(const image::Picture& picture, const Vector3& expected_up_in_cam) const;

 private:
  struct Block {
    int x = 0, y = 0;
    Vector3 ray;
  };
  const image::Mask* mask() const { return own_aircraft_ ? &*own_aircraft_ : nullptr; }
  lens::Lens lens_;
  std::optional<image::Mask> own_aircraft_;
  int step_;
  std::vector<Block> blocks_;
};

// The share of a pixel's area, 0..1, that lies below the horizon of this upward direction: the
// horizon is straight within the pixel. `nominal_from_frame` takes the pixel to the place whose ray
// the lens gives. 0 beyond the lens's field.
float share_below(const lens::Lens& lens,
                  const Vector3& up_in_cam,
                  const Homography& nominal_from_frame,
                  int x,
                  int y);

// The attitude of a camera in which up has this direction. Its yaw is 0.
YawPitchRoll attitude_from_up(const Vector3& up_in_cam);
// Up in cam, from the up direction of the plane through the horizon that is seen ahead, which lies
// below the horizontal by its dip (horizon_dip.h), and the other way round. A camera that looks
// straight up or down has no horizon ahead: they are equal.
Vector3 up_from_seen(const Vector3& seen_up_in_cam, double dip_rad);
Vector3 seen_from_up(const Vector3& up_in_cam, double dip_rad);

// cam_from_level, where level is the north-east-down frame turned to the camera's yaw.
Quaternion cam_from_level(const Vector3& up_in_cam);

// Corrects the drift of a measured rotation in pitch and roll by the horizons that are detected on
// the way. Yaw is not observable. The filter (Kalman 1960) has two unknowns, each an angle in two
// directions: the direction of up in the reference, and the error of the measured rotation by now.
// The error grows where key frames are linked to one another and where tracking starts anew.
// Between these events the rotation is far more accurate than a detected horizon, and the filter
// leaves it as it is.
class HorizonHold {
 public:
  // Adds the error that the rotation gained since the previous frame, as a standard deviation.
  void stray(double sigma_rad);
  // The standard deviation of the error of the rotation.
  double uncertainty_rad() const;
  // Updates the filter by a horizon in a frame whose measured rotation (cam_from_reference) is
  // given. Returns false and ignores the horizon where it lies more than 4 standard deviations from
  // the prediction.
  bool see(const Quaternion& cam_from_reference, const Vector3& up_in_cam);
  // The predicted up direction in a frame's camera; empty before the first horizon.
  std::optional<Vector3> expected_up(const Quaternion& cam_from_reference) const;
  // The measured rotation with the correction applied.
  Quaternion held(const Quaternion& cam_from_reference) const;

 private:
  Vector3 up_in_reference(const Eigen::Vector2d& angles) const;
  std::optional<Quaternion> reference_from_up_;      // its z axis is the first horizon's up
  Eigen::Matrix2d state_ = Eigen::Matrix2d::Zero();  // rows: up, stray; columns: the two angles
  Eigen::Matrix2d covariance_ = Eigen::Matrix2d::Zero();  // of up and stray
};

}  // namespace airtruth::horizon
