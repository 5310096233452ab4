// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <osg/Geometry>
#include <osg/MatrixTransform>
#include <osg/Texture2D>

#include "aircraft/model/mesh.h"
#include "picture/backdrop/backdrop.h"

namespace airtruth::backdrop {

// The textures of one mesh, which all its instances share.
std::vector<osg::ref_ptr<osg::Texture2D>> osg_textures(const model::Mesh& mesh);

// One aircraft in the scene graph: a transform for the body and one below it for each part.
class OsgMesh {
 public:
  OsgMesh(const model::Mesh& mesh, const std::vector<osg::ref_ptr<osg::Texture2D>>& textures);
  osg::Node* node() const { return body_.get(); }
  // Radius of a sphere about the body's origin that contains the aircraft with its propellers at
  // any angle.
  double radius_m() const { return radius_m_; }

  // Sets the poses of body and propellers, and sorts translucent triangles back to front.
  void place(const Instance& instance, const Rigid& cam_from_world);

 private:
  struct Translucent {
    std::size_t part = 0;
    osg::ref_ptr<osg::Geometry> geometry;
  };
  void add_part(std::size_t part, const std::vector<osg::ref_ptr<osg::Texture2D>>& textures);

  const model::Mesh& mesh_;
  osg::ref_ptr<osg::MatrixTransform> body_;
  std::vector<osg::ref_ptr<osg::MatrixTransform>> parts_;
  std::vector<Translucent> translucent_;
  double radius_m_ = 0;
};

}  // namespace airtruth::backdrop
