// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "camera/lens/lens.h"

// The three models' own arithmetic; everybody else uses lens.h.
namespace airtruth::lens {

// How far a model reaches: the largest angle from the axis, and a bound on the distorted radius
// (pixels from the principal point over the focal length) that any ray up to there is mapped to.
struct Field {
  double max_angle_rad = 0;
  double max_radius = 0;
};

// A curve with less slope than this, per radian, counts as having stopped rising: beyond it a
// double no longer tells an angle from its pixel within 1e-9 rad.
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
