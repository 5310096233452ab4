// SPDX-License-Identifier: Apache-2.0
#include "lens/models.h"

namespace airtruth::lens {

std::optional<Pixel> project(const Pinhole& lens, const Vector3& p, double) {
  if (!(p.z() > 0)) return std::nullopt;
  return Pixel(lens.focal_px.x() * p.x() / p.z() + lens.principal_point_px.x(),
               lens.focal_px.y() * p.y() / p.z() + lens.principal_point_px.y());
}

std::optional<Vector3> unproject(const Pinhole& lens, const Pixel& pixel, double) {
  const Pixel n = (pixel - lens.principal_point_px).cwiseQuotient(lens.focal_px);
  return Vector3(n.x(), n.y(), 1).normalized();
}

}  // namespace airtruth::lens
