// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "aircraft/wrapper/condition.h"
#include "aircraft/wrapper/wrapper.h"

// What the animations of a wrapper, and of those that nest it, do to one object
// of a model.
namespace airtruth::aircraft {

struct Spin {
  std::string name;
  Eigen::Vector3f axis_in_body;
  Eigen::Vector3f centre_in_body;
  double revolutions_per_s;
};

struct Animated {
  bool hidden = false;
  Eigen::Affine3d body_from_model = Eigen::Affine3d::Identity();
  std::optional<Spin> spin;
  float opacity = 1;
  std::string texture;  // in place of the object's own
};

// FlightGear puts an animation into the tree of named nodes right above the
// node it names (or, where it names none, above all of its wrapper's), in the
// order of the file, nested wrappers first.
class Scope {
 public:
  Scope(const Eigen::Affine3d& body_from_outside, const Cruise& cruise);

  // The scope inside a wrapper that stands in this one.
  Scope inside(const Wrapper& wrapper) const;
  // An object of the innermost wrapper's model, by the names of its nodes,
  // outermost first.
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
  void apply(const Animation& animation, Animated& result) const;

  Eigen::Affine3d body_from_outside_;
  Cruise cruise_;
  std::vector<Link> links_;
  std::vector<Level> levels_;
};

}  // namespace airtruth::aircraft
