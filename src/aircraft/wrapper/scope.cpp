// SPDX-License-Identifier: Apache-2.0
#include "aircraft/wrapper/scope.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace airtruth::aircraft {
namespace {

constexpr double kSeenFrom_m = 50;  // the viewing distance that selects the level of detail; chosen
constexpr std::size_t kMaxLinks = 512;
constexpr double kFastestPropellerRpm = 3000;  // wrappers state what flickers well in a game

Eigen::Affine3d about(const Vector3& centre, const Eigen::Affine3d& map) {
  return Eigen::Translation3d(centre) * map * Eigen::Translation3d(-centre);
}

Eigen::Affine3d motion_of(const Animation& animation, const Cruise& cruise) {
  const double length = animation.axis.norm();
  if (animation.type == "scale") {
    Vector3 scale;
    for (int i = 0; i < 3; ++i)
      scale[i] = value_of(animation.scale[static_cast<std::size_t>(i)], cruise);
    return about(animation.centre, Eigen::Affine3d(Eigen::Matrix3d(scale.asDiagonal())));
  }
  if (!(length > 1e-9)) return Eigen::Affine3d::Identity();
  const Vector3 axis = animation.axis / length;
  const double value = value_of(animation.value, cruise);
  if (animation.type == "rotate")
    return about(animation.centre, Eigen::Affine3d(Eigen::AngleAxisd(radians(value), axis)));
  return Eigen::Affine3d(Eigen::Translation3d(value * axis));
}

// Wheels do not turn in the air, although many wrappers turn them with the airspeed.
bool is_wheel(const Animation& animation) {
  return std::any_of(
      animation.objects.begin(), animation.objects.end(), [](const std::string& object) {
        std::string name = object;
        for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        for (const char* word : {"wheel", "tire", "tyre", "roue", "gear"})
          if (name.find(word) != std::string::npos) return true;
        return false;
      });
}

}  // namespace

Scope::Scope(const Eigen::Affine3d& body_from_outside, const Cruise& cruise)
    : body_from_outside_(body_from_outside), cruise_(cruise) {}

Scope Scope::inside(const Wrapper& wrapper) const {
  Scope scope = *this;
  scope.links_.push_back({wrapper.name, nullptr, wrapper.parent_from_nested});
  scope.links_.push_back({"", nullptr, wrapper.nested_from_model});
  scope.levels_.push_back({&wrapper, scope.links_.size()});
  return scope;
}

void Scope::install(const Animation& animation, std::size_t begin, std::vector<Link>& links) {
  const Link link{animation.name, &animation, Eigen::Affine3d::Identity()};
  const auto at = [&](std::size_t i) { return links.begin() + static_cast<std::ptrdiff_t>(i); };
  if (animation.objects.empty()) {
    links.insert(at(begin), link);
    return;
  }
  for (std::size_t i = links.size(); i-- > begin;) {
    const auto& objects = animation.objects;
    if (links.size() < kMaxLinks &&
        std::find(objects.begin(), objects.end(), links[i].name) != objects.end())
      links.insert(at(i), link);
  }
}

void Scope::apply(const Animation& animation, Animated& result) const {
  const std::string& type = animation.type;
  const bool applies = !animation.condition || holds(*animation.condition, cruise_);
  if (type == "select") {
    result.hidden = result.hidden || !applies;
  } else if (type == "range") {
    result.hidden =
        result.hidden || kSeenFrom_m < animation.least_m || kSeenFrom_m >= animation.most_m;
  } else if (type == "billboard" || type == "flash" || type == "dist-scale" || type == "timed") {
    result.hidden = true;  // lamps
  } else if (!applies) {
    return;
  } else if (type == "blend") {
    result.opacity *=
        1 - static_cast<float>(std::clamp(value_of(animation.value, cruise_), 0., 1.));
  } else if (type == "material") {
    if (!animation.texture.empty()) result.texture = animation.texture;
  } else if (type == "spin") {
    const double rpm =
        std::clamp(value_of(animation.value, cruise_), -kFastestPropellerRpm, kFastestPropellerRpm);
    if (result.spin || rpm == 0 || !(animation.axis.norm() > 1e-9) || is_wheel(animation)) return;
    const Eigen::Affine3d& body_from_model = result.body_from_model;
    result.spin = Spin{animation.objects.empty() ? "spinning" : animation.objects.front(),
                       (body_from_model.linear() * animation.axis).normalized().cast<float>(),
                       (body_from_model * animation.centre).cast<float>(),
                       rpm / 60};
  } else if (type == "rotate" || type == "translate" || type == "scale") {
    result.body_from_model = result.body_from_model * motion_of(animation, cruise_);
  }
}

Animated Scope::animated(const std::vector<std::string>& names) const {
  std::vector<Link> links = links_;
  for (const std::string& name : names)
    links.push_back({name, nullptr, Eigen::Affine3d::Identity()});
  for (auto level = levels_.rbegin(); level != levels_.rend(); ++level)
    for (const Animation& animation : level->wrapper->animations)
      install(animation, level->begin, links);
  Animated result;
  result.body_from_model = body_from_outside_;
  for (const Link& link : links) {
    result.body_from_model = result.body_from_model * link.parent_from_here;
    if (link.animation != nullptr) apply(*link.animation, result);
  }
  return result;
}

}  // namespace airtruth::aircraft
