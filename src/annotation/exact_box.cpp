// SPDX-License-Identifier: Apache-2.0
#include "annotation/exact_box.h"

#include "base/error.h"

namespace airtruth::annotation {
namespace {

std::optional<Pixel> pixel_from_cam(const Sight& sight, const Vector3& p_in_cam) {
  const auto nominal = sight.lens->pixel_from_cam(p_in_cam);
  if (!nominal) return std::nullopt;
  // A homography has a horizon, and the image lies on one side of it.
  const auto size = sight.lens->size();
  const double w_of_image =
      (sight.frame_from_nominal.row(2) * Vector3(size.width / 2.0, size.height / 2.0, 1)).value();
  const Vector3 q = sight.frame_from_nominal * Vector3(nominal->x(), nominal->y(), 1);
  if (!(q.z() * w_of_image > 0)) return std::nullopt;
  const Pixel pixel(q.x() / q.z(), q.y() / q.z());
  return pixel.allFinite() ? std::optional(pixel) : std::nullopt;
}

}  // namespace

std::optional<Pixel> pixel_from_world(const Sight& sight, const Vector3& p_in_world) {
  return pixel_from_cam(sight, sight.cam_from_world * p_in_world);
}

ExactBox exact_box(const Sight& sight,
                   const Silhouette& silhouette,
                   const Rigid& world_from_body,
                   double time_s) {
  check(silhouette.mesh && silhouette.points.size() == silhouette.mesh->parts.size(),
        "a silhouette has the parts of its mesh");
  const Rigid cam_from_body = sight.cam_from_world * world_from_body;
  const Matrix3 rotation = cam_from_body.rotation.toRotationMatrix();
  BoxBounds bounds;
  ExactBox result;
  for (std::size_t part = 0; part < silhouette.points.size(); ++part) {
    const Eigen::Affine3d body_from_part =
        aircraft::body_from_part(silhouette.mesh->parts[part], time_s).cast<double>();
    const Matrix3 cam_from_part = rotation * body_from_part.linear();
    const Vector3 part_in_cam = rotation * body_from_part.translation() + cam_from_body.translation;
    for (const Eigen::Vector3f& point : silhouette.points[part]) {
      const auto pixel = pixel_from_cam(sight, cam_from_part * point.cast<double>() + part_in_cam);
      if (pixel)
        bounds.add(*pixel);
      else
        result.partly_unseen = true;
    }
  }
  result.box = bounds.box();
  return result;
}

}  // namespace airtruth::annotation
