// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "camera/lens/models.h"

namespace airtruth::lens {

Field field_of(const Pinhole&) { return {kPi / 2, std::numeric_limits<double>::infinity()}; }

std::optional<Pixel> project(const Pinhole& lens, const Vector3& p, const Field&) {
  if (!(p.z() > 0)) return std::nullopt;
  const Pixel pixel(lens.focal_px.x() * p.x() / p.z() + lens.principal_point_px.x(),
                    lens.focal_px.y() * p.y() / p.z() + lens.principal_point_px.y());
  if (!std::isfinite(pixel.x()) || !std::isfinite(pixel.y())) return std::nullopt;
  return pixel;
}

std::optional<Vector3> unproject(const Pinhole& lens, const Pixel& pixel, const Field&) {
  const Pixel n = (pixel - lens.principal_point_px).cwiseQuotient(lens.focal_px);
  return Vector3(n.x(), n.y(), 1).normalized();
}

}  // namespace airtruth::lens
