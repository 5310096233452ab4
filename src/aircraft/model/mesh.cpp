// SPDX-License-Identifier: Apache-2.0
#include "aircraft/model/mesh.h"

#include <cmath>

namespace airtruth::aircraft {

std::size_t Mesh::triangle_count() const {
  std::size_t count = 0;
  for (const Part& part : parts) count += part.triangles.size();
  return count;
}

Eigen::Affine3f body_from_part(const Part& part, double time_s) {
  Eigen::Affine3f result = Eigen::Affine3f::Identity();
  if (!part.spins) return result;
  const double turns = part.revolutions_per_s * time_s;
  const auto angle = static_cast<float>(2 * kPi * (turns - std::floor(turns)));
  result.translate(part.centre_in_body);
  result.rotate(Eigen::AngleAxisf(angle, part.axis_in_body.normalized()));
  result.translate(-part.centre_in_body);
  return result;
}

}  // namespace airtruth::aircraft
