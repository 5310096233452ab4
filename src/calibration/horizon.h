// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "calibration/calibration.h"
#include "geometry/transform.h"
#include "image/colour.h"

namespace airtruth::calibration {

// Sky and ground as the two sides of a plane through the camera, that a lens bends as it bends all
// else: the plane that parts the colours of the picture best (Ettinger et al. 2002, "Vision-guided
// flight stability and control for micro air vehicles", with Fisher's criterion for their
// determinants, and planes for their lines).
class HorizonFinder {
 public:
  HorizonFinder(const lens::Lens& lens, const image::Mask* own_aircraft);

  struct Found {
    Vector3 up_in_cam{0, -1, 0};
    double separation = 0;  // of sky and ground, in standard deviations
  };
  // Empty where no plane parts the picture clearly, or less than 6 % lies on one side.
  std::optional<Found> find(const image::Picture& picture) const;

 private:
  struct Block {
    int x = 0, y = 0;
    Vector3 ray;
  };
  lens::Lens lens_;
  int step_;
  std::vector<Block> blocks_;
};

// Attitude of a camera that sees up in that direction, its yaw taken as 0.
YawPitchRoll attitude_from_up(const Vector3& up_in_cam);
Quaternion cam_from_level(
    const Vector3& up_in_cam);  // level: north-east-down with the camera's yaw

}  // namespace airtruth::calibration
