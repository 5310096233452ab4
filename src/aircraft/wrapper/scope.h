// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "aircraft/model/mesh.h"
#include "aircraft/wrapper/wrapper.h"

// The combined effect of the animations of a wrapper, and of the wrappers around it, on one object.
namespace airtruth::wrapper {

struct Animated {
  bool hidden = false;
  Eigen::Affine3d body_from_model = Eigen::Affine3d::Identity();
  std::optional<model::Part> spin;  // without triangles
  float opacity = 1;
  std::string texture;  // in place of the object's own
};

// What an animation does in the state that its wrapper was read for, as text. Animations that
// differ only in a value without effect, such as the turns of a wheel, have the same.
std::string effect_of(const Animation& animation);

// FlightGear inserts an animation directly above each node that it names (or above the whole model
// where it names none), in the order of the file, outer wrappers first.
class Scope {
 public:
  explicit Scope(const Eigen::Affine3d& body_from_outside)
      : body_from_outside_(body_from_outside) {}

  // The scope inside a wrapper that is nested in this one.
  Scope inside(const Wrapper& wrapper) const;
  // The effect on an object of the innermost wrapper's model. `names` are its nodes, outermost
  // first.
  Animated animated(const std::vector<std::string>& names) const;

 private:
  struct Link {
    std::string name;
    const Animation* animation = nullptr;
    Eigen::Affine3d parent_from_here = Eigen::Affine3d::Identity();
  };
  struct Level {
    const Wrapper* wrapper;
    std::size_t begin;  // its content's first link
  };
  static void install(const Animation& animation, std::size_t begin, std::vector<Link>& links);

  Eigen::Affine3d body_from_outside_;
  std::vector<Link> links_;
  std::vector<Level> levels_;
};

}  // namespace airtruth::wrapper
