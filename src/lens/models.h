// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lens/lens.h"

// The three models' own arithmetic; everybody else uses lens.h.
namespace airtruth::lens {

std::optional<Pixel> project(const Pinhole& lens, const Vector3& p_in_cam, double max_angle_rad);
std::optional<Pixel> project(const BrownConrady& lens,
                             const Vector3& p_in_cam,
                             double max_angle_rad);
std::optional<Pixel> project(const Fisheye& lens, const Vector3& p_in_cam, double max_angle_rad);

std::optional<Vector3> unproject(const Pinhole& lens, const Pixel& pixel, double max_angle_rad);
std::optional<Vector3> unproject(const BrownConrady& lens,
                                 const Pixel& pixel,
                                 double max_angle_rad);
std::optional<Vector3> unproject(const Fisheye& lens, const Pixel& pixel, double max_angle_rad);

// The largest angle from the axis up to which the radial curve rises from the axis on.
double max_angle(const BrownConrady& lens);
double max_angle(const Fisheye& lens);

}  // namespace airtruth::lens
