// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "camera/lens/lens.h"

// The arithmetic of the three lens models. Other modules use lens.h.
namespace airtruth::lens {

// The valid field of a model: the largest angle from the axis, and an upper bound on the distorted
// radius (distance from the principal point in pixels over the focal length) of any ray within that
// angle.
struct Field {
  double max_angle_rad = 0;
  double max_radius = 0;
};

// The least slope, per radian, of a curve that still rises. At a lower slope an angle cannot be
// recovered from its pixel within 1e-9 rad in double precision.
inline constexpr double kFlat = 1e-4;

Field field_of(const Pinhole& lens);
Field field_of(const BrownConrady& lens);
Field field_of(const Fisheye& lens);

std::optional<Pixel> project(const Pinhole& lens, const Vector3& p_in_cam, const Field& field);
std::optional<Pixel> project(const BrownConrady& lens, const Vector3& p_in_cam, const Field& field);
std::optional<Pixel> project(const Fisheye& lens, const Vector3& p_in_cam, const Field& field);

std::optional<Vector3> unproject(const Pinhole& lens, const Pixel& pixel, const Field& field);
std::optional<Vector3> unproject(const BrownConrady& lens, const Pixel& pixel, const Field& field);
std::optional<Vector3> unproject(const Fisheye& lens, const Pixel& pixel, const Field& field);

}  // namespace airtruth::lens
