// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/level.h"

#include <fmt/format.h>

#include "foundation/base/median.h"
#include "foundation/image/colour.h"

namespace airtruth::camera_file {

Horizons accepted_horizons(const horizon::HorizonFinder& finder,
                           const std::vector<SampledFrame>& frames,
                           const std::function<void()>& before_each) {
  Horizons result;
  std::size_t blurred = 0, sharp = 0;
  for (const SampledFrame& frame : frames) {
    before_each();
    FoundHorizon& found = result.found.emplace_back(finder.find(frame.picture));
    if (!found) continue;
    ++(found->is_sharp() ? sharp : blurred);
    if (!found->is_sharp()) found.reset();
  }
  if (sharp == 0 && blurred == 0) {
    result.why_none = fmt::format("in none of {} frames do a sky and a ground part", frames.size());
  } else if (sharp < blurred) {
    result.why_none = fmt::format(
        "a line that is sharp from side to side parts sky and ground in {} of {} frames; in {} "
        "they part without one, as at a coast, hills, haze or clouds: no pitch, roll or sky is "
        "taken from it",
        sharp,
        frames.size(),
        blurred);
    for (FoundHorizon& found : result.found) found.reset();
  } else if (blurred > 0) {
    result.note = fmt::format(
        "measured in {} of {} frames; in {} sky and ground part without a line that "
        "is sharp from side to side, and these are left out",
        sharp,
        frames.size(),
        blurred);
  }
  return result;
}

std::optional<Quaternion> level_attitude(const std::vector<SampledFrame>& frames,
                                         const std::vector<FoundHorizon>& horizons,
                                         double heading_deg,
                                         double horizon_dip_rad) {
  // The upward directions in the camera frame of the first frame.
  std::vector<Vector3> ups;
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (horizons[i] && frames[i].cam_from_first)
      ups.push_back(frames[i].cam_from_first->conjugate() *
                    horizon::up_from_seen(horizons[i]->up_in_cam, horizon_dip_rad));
  if (ups.empty()) return std::nullopt;
  Vector3 middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Vector3& up : ups) values.push_back(up[axis]);
    middle[axis] = median(std::move(values));
  }
  const Quaternion cam_from_heading = horizon::cam_from_level(middle.normalized());
  const Quaternion heading(Eigen::AngleAxisd(-radians(heading_deg), Vector3::UnitZ()));
  return cam_from_heading * heading;
}

std::optional<image::Rgb8> tinted_sky(const lens::Lens& lens,
                                      const std::vector<SampledFrame>& frames,
                                      const std::vector<FoundHorizon>& horizons) {
  std::vector<std::size_t> with;
  for (std::size_t i = 0; i < horizons.size(); ++i)
    if (horizons[i]) with.push_back(i);
  if (with.empty()) return std::nullopt;
  const std::size_t i = with[with.size() / 2];
  image::Rgb8 picture = image::rgb8_from_picture(frames[i].picture);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto ray = lens.ray_from_pixel({x + 0.5, y + 0.5});
      if (!ray || ray->dot(horizons[i]->up_in_cam) <= 0) continue;
      std::uint8_t* p = picture.at(x, y);
      p[0] = static_cast<std::uint8_t>(p[0] * 3 / 4 + 60);
      p[1] = static_cast<std::uint8_t>(p[1] * 3 / 4);
      p[2] = static_cast<std::uint8_t>(p[2] * 3 / 4);
    }
  return picture;
}

}  // namespace airtruth::camera_file
