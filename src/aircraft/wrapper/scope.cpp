// SPDX-License-Identifier: Apache-2.0
#include "aircraft/wrapper/scope.h"

#include <algorithm>

#include <fmt/format.h>

#include "aircraft/wrapper/part_names.h"

namespace airtruth::wrapper {
namespace {

constexpr double kSeenFrom_m = 50;  // the viewing distance that selects the level of detail; chosen
// Number of links: a bound for untrusted files.
constexpr std::size_t kMaxLinks = 512;
constexpr double kFastestPropellerRpm = 3000;  // wrappers state what flickers well in a game

Eigen::Affine3d about(const Vector3& centre, const Eigen::Affine3d& map) {
  return Eigen::Translation3d(centre) * map * Eigen::Translation3d(-centre);
}

Eigen::Affine3d motion_of(const Animation& animation) {
  const double length = animation.axis.norm();
  if (animation.type == "scale")
    return about(animation.centre, Eigen::Affine3d(Eigen::Matrix3d(animation.scale.asDiagonal())));
  if (!(length > 1e-9)) return Eigen::Affine3d::Identity();
  const Vector3 axis = animation.axis / length;
  if (animation.type == "rotate")
    return about(animation.centre,
                 Eigen::Affine3d(Eigen::AngleAxisd(radians(animation.value), axis)));
  return Eigen::Affine3d(Eigen::Translation3d(animation.value * axis));
}

double rpm_of(const Animation& animation) {
  // Wheels do not turn in the air, although many wrappers turn them with the airspeed.
  if (std::any_of(animation.objects.begin(), animation.objects.end(), is_wheel)) return 0;
  return std::clamp(animation.value, -kFastestPropellerRpm, kFastestPropellerRpm);
}

std::optional<model::Part> spin_of(const Animation& animation,
                                   const Eigen::Affine3d& body_from_model) {
  const double rpm = rpm_of(animation);
  if (rpm == 0 || !(animation.axis.norm() > 1e-9)) return std::nullopt;
  return model::Part{
      .name = animation.objects.empty() ? "spinning" : animation.objects.front(),
      .triangles = {},
      .spins = true,
      .axis_in_body = (body_from_model.linear() * animation.axis).normalized().cast<float>(),
      .centre_in_body = (body_from_model * animation.centre).cast<float>(),
      .revolutions_per_s = rpm / 60};
}

bool is_lamp(const std::string& type) {
  return type == "billboard" || type == "flash" || type == "dist-scale" || type == "timed";
}

float opacity_of(const Animation& animation) {
  return 1 - static_cast<float>(std::clamp(animation.value, 0., 1.));
}

void apply(const Animation& animation, Animated& result) {
  const std::string& type = animation.type;
  const bool applies = animation.condition.value_or(true);
  if (type == "select") {
    result.hidden = result.hidden || !applies;
  } else if (type == "range") {
    result.hidden =
        result.hidden || kSeenFrom_m < animation.least_m || kSeenFrom_m >= animation.most_m;
  } else if (is_lamp(type)) {
    result.hidden = true;
  } else if (!applies) {
    return;
  } else if (type == "blend") {
    result.opacity *= opacity_of(animation);
  } else if (type == "material") {
    if (!animation.texture.empty()) result.texture = animation.texture;
  } else if (type == "spin") {
    if (!result.spin) result.spin = spin_of(animation, result.body_from_model);
  } else if (type == "rotate" || type == "translate" || type == "scale") {
    result.body_from_model = result.body_from_model * motion_of(animation);
  }
}

}  // namespace

std::string effect_of(const Animation& animation) {
  const std::string& type = animation.type;
  if (type == "range" || is_lamp(type)) return "";
  if (!animation.condition.value_or(true)) return "-";
  // Every bit of a number counts.
  if (type == "blend") return fmt::format("{:a}", opacity_of(animation));
  if (type == "spin") return fmt::format("{:a}", rpm_of(animation));
  if (type == "rotate" || type == "translate") return fmt::format("{:a}", animation.value);
  if (type == "scale")
    return fmt::format(
        "{:a},{:a},{:a}", animation.scale.x(), animation.scale.y(), animation.scale.z());
  return "";
}

Scope Scope::inside(const Wrapper& wrapper) const {
  Scope scope = *this;
  scope.links_.push_back({wrapper.name, nullptr, wrapper.parent_from_nested});
  scope.links_.push_back(
      {"", nullptr, wrapper.nested_from_model.value_or(Eigen::Affine3d::Identity())});
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

}  // namespace airtruth::wrapper
