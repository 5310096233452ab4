// SPDX-License-Identifier: Apache-2.0
#include "picture/backdrop/osg_adapter.h"

namespace airtruth::backdrop {
namespace {

// OpenGL's eye has y up and looks along -z; the camera has y down and looks along +z.
const Vector3 kEyeFromCam{1, -1, -1};

}  // namespace

osg::Matrixd osg_from_affine(const Eigen::Affine3d& b_from_a) {
  return osg::Matrixd(b_from_a.data());  // both hold a column of this after another
}

osg::Matrixd eye_from_world(const Rigid& cam_from_world) {
  return osg_from_affine(Eigen::Affine3d(Eigen::Scaling(kEyeFromCam)) * cam_from_world.affine());
}

osg::Vec3f eye_direction_from_world(const Rigid& cam_from_world,
                                    const Vector3& direction_in_world) {
  const Vector3 direction_in_cam = cam_from_world.rotation * direction_in_world;
  return osg_from_vector(kEyeFromCam.cwiseProduct(direction_in_cam).normalized().cast<float>());
}

osg::Matrixd projection(const lens::Pinhole& lens, const Window& window) {
  const double x_per_px = window.near_m / lens.focal_px.x();
  const double y_per_px = window.near_m / lens.focal_px.y();
  const double left = (window.in_frame.x - lens.principal_point_px.x()) * x_per_px;
  const double right = (window.in_frame.right() - lens.principal_point_px.x()) * x_per_px;
  const double top = (lens.principal_point_px.y() - window.in_frame.y) * y_per_px;
  const double bottom = (lens.principal_point_px.y() - window.in_frame.bottom()) * y_per_px;
  return osg::Matrixd::frustum(left, right, bottom, top, window.near_m, window.far_m);
}

}  // namespace airtruth::backdrop
