// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace airtruth::ac3d {

// The scalar product, written out so that every compiler adds in the same order and the result is
// the same.
float dot_product(const Eigen::Vector3f& a, const Eigen::Vector3f& b);

// Twice the area of a polygon times its normal: the sum over the fan of its first corner.
Eigen::Vector3f area_normal(std::span<const Eigen::Vector3f> corners);

// Whether the polygon needs another triangulation than a fan, which is where two neighbouring
// corners turn in opposite directions.
bool is_concave(std::span<const Eigen::Vector3f> corners);

// Triangulates a simple polygon by ear clipping (Meisters 1975) in the plane normal to `normal`.
// Returns corners.size() - 2 triangles as indices into `corners`. Where the polygon crosses itself
// and no ear exists, the corner that overlaps least is cut.
std::vector<std::array<std::uint32_t, 3>> ear_clipped(std::span<const Eigen::Vector3f> corners,
                                                      const Eigen::Vector3f& normal);

}  // namespace airtruth::ac3d
