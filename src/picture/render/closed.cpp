// SPDX-License-Identifier: Apache-2.0
#include "picture/render/closed.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "foundation/geometry/transform.h"

namespace airtruth::render {
namespace {

// By surface: true where every side is passed as often one way as the other.
std::vector<bool> are_closed(const Surfaces& surfaces) {
  std::vector<bool> closed(surfaces.count, true);
  std::vector<std::pair<std::uint32_t, int>> passes;  // surface, direction
  for_each_side(surfaces.sides, [&](auto first, auto last) {
    passes.clear();
    for (auto side = first; side != last; ++side)
      passes.emplace_back(surfaces.of[side->triangle],
                          side->direction * surfaces.sign[side->triangle]);
    std::sort(passes.begin(), passes.end());
    int sum = 0;
    for (std::size_t i = 0; i < passes.size(); ++i) {
      sum += passes[i].second;
      if (i + 1 < passes.size() && passes[i + 1].first == passes[i].first) continue;
      if (sum != 0) closed[passes[i].first] = false;
      sum = 0;
    }
  });
  return closed;
}

// By surface: the volume that it encloses, positive where its normals, each times its sign, point
// outwards (divergence theorem).
std::vector<double> volumes_m3(const aircraft::Mesh& mesh,
                               const aircraft::Part& part,
                               const Surfaces& surfaces) {
  std::vector<double> volumes(surfaces.count, 0.0);
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    if (surfaces.of[t] == kNoSurface) continue;
    const auto& [a, b, c] = part.triangles[t].vertex;
    const Vector3 p = mesh.positions[a].cast<double>();
    const Vector3 q = mesh.positions[b].cast<double>();
    const Vector3 r = mesh.positions[c].cast<double>();
    volumes[surfaces.of[t]] += surfaces.sign[t] * p.dot(q.cross(r)) / 6;
  }
  return volumes;
}

std::vector<std::int8_t> outward_of(const aircraft::Mesh& mesh,
                                    const aircraft::Part& part,
                                    const Surfaces& surfaces,
                                    const std::vector<std::uint8_t>& opaque) {
  // A cubic centimetre: a surface that encloses less is a sheet with two sides.
  constexpr double kLeastVolumeM3 = 1e-6;
  std::vector<bool> closed = are_closed(surfaces);
  for (std::size_t t = 0; t < part.triangles.size(); ++t)
    if (surfaces.of[t] != kNoSurface && opaque[t] == 0) closed[surfaces.of[t]] = false;
  const std::vector<double> volumes = volumes_m3(mesh, part, surfaces);
  std::vector<std::int8_t> outward(part.triangles.size(), 0);
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    const std::uint32_t s = surfaces.of[t];
    if (s == kNoSurface || !closed[s] || !(std::abs(volumes[s]) > kLeastVolumeM3)) continue;
    outward[t] = static_cast<std::int8_t>(volumes[s] > 0 ? surfaces.sign[t] : -surfaces.sign[t]);
  }
  return outward;
}

}  // namespace

std::vector<std::vector<std::int8_t>> outward_normals(
    const aircraft::Mesh& mesh,
    const std::vector<Surfaces>& surfaces,
    const std::vector<std::vector<std::uint8_t>>& opaque) {
  std::vector<std::vector<std::int8_t>> outward;
  for (std::size_t p = 0; p < mesh.parts.size(); ++p)
    outward.push_back(outward_of(mesh, mesh.parts[p], surfaces[p], opaque[p]));
  return outward;
}

}  // namespace airtruth::render
