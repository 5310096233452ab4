// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <osg/Matrixd>
#include <osg/Vec3f>

#include "camera/lens/lens.h"
#include "foundation/geometry/box.h"
#include "foundation/geometry/transform.h"

// The only place that uses OpenSceneGraph's row vectors and OpenGL's "eye" frame, whose y points
// upwards and whose z points backwards.
namespace airtruth::backdrop {

osg::Matrixd osg_from_affine(const Eigen::Affine3d& b_from_a);
osg::Matrixd eye_from_world(const Rigid& cam_from_world);
osg::Vec3f eye_direction_from_world(const Rigid& cam_from_world, const Vector3& direction_in_world);

// The part of the frame that is drawn, and the range of distances along the camera's axis.
struct Window {
  // In pixels.
  Box in_frame;
  double near_m = 1;
  double far_m = 2;
};
osg::Matrixd projection(const lens::Pinhole& lens, const Window& window);

inline osg::Vec3f osg_from_vector(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace airtruth::backdrop
