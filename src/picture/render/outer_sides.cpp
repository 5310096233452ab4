// SPDX-License-Identifier: Apache-2.0
#include "picture/render/outer_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "picture/render/closed.h"
#include "picture/render/surfaces.h"

namespace airtruth::render {
namespace {

OuterSides both_of(OuterSides a, OuterSides b) { return static_cast<OuterSides>(a | b); }

OuterSides turned(OuterSides sides) {
  if (sides == kFrontSide) return kBackSide;
  return sides == kBackSide ? kFrontSide : sides;
}

bool sees_open(const SideOpenness& side) {
  return std::any_of(side.corner.begin(), side.corner.end(), [](const Openness& corner) {
    return corner.share > 0;
  });
}

// The sides of a triangle from which a ray leaves the aircraft.
OuterSides open_sides(const TriangleOpenness& openness) {
  return both_of(sees_open(openness.front) ? kFrontSide : kNoSide,
                 sees_open(openness.back) ? kBackSide : kNoSide);
}

// By surface: the sides from which a ray leaves the aircraft at any of its triangles. The front is
// that of a triangle whose sign in `surfaces` is 1. A surface that has one side only has both.
std::vector<OuterSides> open_sides_of(const Surfaces& surfaces,
                                      const std::vector<TriangleOpenness>& openness) {
  std::vector<OuterSides> open(surfaces.count, kNoSide);
  for (std::size_t t = 0; t < surfaces.of.size(); ++t) {
    if (surfaces.of[t] == kNoSurface) continue;
    const OuterSides own = open_sides(openness[t]);
    OuterSides& all = open[surfaces.of[t]];
    all = both_of(all, surfaces.sign[t] > 0 ? own : turned(own));
  }
  for_each_side(surfaces.sides, [&](auto first, auto last) {
    if (last - first != 2) return;
    const int a = first[0].direction * surfaces.sign[first[0].triangle];
    const int b = first[1].direction * surfaces.sign[first[1].triangle];
    if (a == b) open[surfaces.of[first[0].triangle]] = kBothSides;
  });
  return open;
}

std::vector<OuterSides> outer_of(const Surfaces& surfaces,
                                 const std::vector<std::int8_t>& outward,
                                 const std::vector<TriangleOpenness>& openness,
                                 bool is_opaque) {
  const std::vector<OuterSides> of_surface = open_sides_of(surfaces, openness);
  std::vector<OuterSides> outer(surfaces.of.size(), kBothSides);
  for (std::size_t t = 0; t < outer.size(); ++t) {
    if (surfaces.of[t] == kNoSurface) continue;
    // The openness does not say what is seen through a pane.
    OuterSides possible = is_opaque ? of_surface[surfaces.of[t]] : kBothSides;
    if (surfaces.sign[t] < 0) possible = turned(possible);
    if (outward[t] == 0) {
      outer[t] = possible;
    } else {
      const OuterSides out = outward[t] > 0 ? kFrontSide : kBackSide;
      outer[t] = both_of(static_cast<OuterSides>(out & possible), open_sides(openness[t]));
    }
  }
  return outer;
}

}  // namespace

std::vector<std::vector<OuterSides>> outer_sides(const Model::Impl& model) {
  const std::vector<Surfaces> surfaces = surfaces_of(model.mesh);
  const auto outward = outward_normals(model.mesh, surfaces, model.opaque);
  const bool is_opaque =
      std::all_of(model.opaque.begin(), model.opaque.end(), [](const auto& of_part) {
        return std::find(of_part.begin(), of_part.end(), 0) == of_part.end();
      });
  std::vector<std::vector<OuterSides>> outer;
  for (std::size_t p = 0; p < surfaces.size(); ++p)
    outer.push_back(outer_of(surfaces[p], outward[p], model.openness[p], is_opaque));
  return outer;
}

bool is_hidden(OuterSides outer, std::span<const double> front_to_eye, double scale) {
  // Sine of the angle between a line of sight and a triangle's plane below which rounding decides
  // which side is seen.
  constexpr double kEdgeOn = 1e-6;
  if (outer == kBothSides) return false;
  if (outer == kNoSide) return true;
  const double sign = outer == kFrontSide ? 1 : -1;
  double most = -std::numeric_limits<double>::infinity();
  for (const double height : front_to_eye) most = std::max(most, sign * height);
  // A parabola goes at most an eighth of the second difference beyond its values.
  if (front_to_eye.size() == 3)
    most += std::abs(front_to_eye[0] - 2 * front_to_eye[1] + front_to_eye[2]) / 8;
  return most < -kEdgeOn * scale;
}

}  // namespace airtruth::render
