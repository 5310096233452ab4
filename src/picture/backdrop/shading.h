// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <osg/StateSet>

#include "aircraft/model/mesh.h"
#include "picture/backdrop/backdrop.h"

namespace airtruth::backdrop {

enum class Encoding { kLinear, kSrgb };
// A textured triangle can be partly opaque and partly translucent, so it is drawn twice: first its
// opaque part, with depth, then its translucent part, blended.
enum class Pass { kOpaque, kTranslucent };

// The shader program, the light and the output encoding, as the state of a scene's root.
class Shading {
 public:
  Shading();
  osg::StateSet* state() const { return state_.get(); }
  void set_light(const shade::Light& light, const Rigid& cam_from_world);
  void set_encoding(Encoding encoding);

 private:
  void set(const char* name, const osg::Vec3f& value);
  osg::ref_ptr<osg::StateSet> state_;
};

bool is_drawn_in(Pass pass, const model::Material& material, const model::Mesh& mesh);

osg::ref_ptr<osg::StateSet> material_state(Pass pass,
                                           const model::Material& material,
                                           osg::Texture* texture);

}  // namespace airtruth::backdrop
