// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include "aircraft/shapes/mesh_builder.h"
#include "aircraft/shapes/shapes.h"
#include "foundation/base/error.h"

namespace airtruth::aircraft {
namespace {

using V = Eigen::Vector3f;

// The outline of a latex envelope in shares of its diameter: a sphere above, drawn out to the neck
// below. Height of the middle above the neck.
struct Outline {
  float above, radius;
};

std::vector<Outline> outline() {
  constexpr int kSteps = 14;
  // Of the sphere's middle; below it the radius shrinks to that of the neck.
  std::vector<Outline> result;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = kPi * i / kSteps;  // 0 at the top
    const double height = std::cos(angle) * (std::cos(angle) < 0 ? 0.68 : 0.5);
    result.push_back({static_cast<float>(height), static_cast<float>(0.5 * std::sin(angle))});
  }
  result.back().radius = 0.03f;
  // The knot.
  result.push_back({-0.70f, 0.022f});
  result.push_back({-0.75f, 0.045f});
  return result;
}

}  // namespace

Mesh balloon(const BalloonShape& shape) {
  check(shape.size_m > 0, "a balloon has a size");
  const auto size = static_cast<float>(shape.size_m);
  MeshBuilder builder;
  const std::uint32_t latex = builder.add_material({static_cast<float>(shape.colour[0]),
                                                    static_cast<float>(shape.colour[1]),
                                                    static_cast<float>(shape.colour[2])},
                                                   Finish::kPaint);
  builder.begin_part({"envelope", {}});
  std::vector<Ring> rings;
  for (const auto& [above, radius] : outline())
    rings.push_back({V(0, 0, -above * size), radius * size, radius * size});
  builder.add_body(rings, V(1, 0, 0), V(0, -1, 0), 24, latex);
  return builder.take();
}

}  // namespace airtruth::aircraft
