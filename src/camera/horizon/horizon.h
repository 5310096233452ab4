// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

namespace airtruth::motion {

// Sky and ground as the two sides of a plane through the camera, that a lens bends as it bends all
// else: the plane that parts the colours of the picture best (Ettinger et al. 2002, "Vision-guided
// flight stability and control for micro air vehicles", with Fisher's criterion for their
// determinants, and planes for their lines). Haze draws that plane down into the ground, so it is
// then moved to the line near it across which the picture steps most evenly (horizon_edge.h).
class HorizonFinder {
 public:
  HorizonFinder(const lens::Lens& lens, const image::Mask* own_aircraft);

  // Least sharpness of a horizon. 92 % of the frames of two real flights over hills and fields have
  // more, as virtual flights have in clear air; in haze of 13 km visibility they have 0.6 to 0.75.
  // Clear and clouded skies without a horizon have 0.4 at most, rows of trees 0.36 to 0.65.
  static constexpr double kSharp = 0.6;
  struct Found {
    Vector3 up_in_cam{0, -1, 0};
    double separation = 0;  // of sky and ground, in standard deviations; of find() alone
    // Share of the line across which the picture steps as an edge does (horizon_edge.h). Below
    // kSharp the plane is only the one that parts the colours, as a coast, a bank of clouds or a
    // sky that brightens downwards do too, and is no horizon.
    double sharpness = 0;
    bool is_sharp() const { return sharpness >= kSharp; }
  };
  // Empty where no plane parts the picture clearly, or less than 6 % lies on one side.
  std::optional<Found> find(const image::Picture& picture) const;
  // The same within a degree and a half of where it is expected, twenty times as fast.
  Found follow(const image::Picture& picture, const Vector3& expected_up_in_cam) const;

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

// Attitude of a camera that sees up in that direction, its yaw taken as 0.
YawPitchRoll attitude_from_up(const Vector3& up_in_cam);
Quaternion cam_from_level(
    const Vector3& up_in_cam);  // level: north-east-down with the camera's yaw

}  // namespace airtruth::motion
