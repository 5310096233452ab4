// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "aircraft/model/mesh.h"

// A mesh for the tests of this module.
namespace airtruth::shade {

// Adds a triangle with vertices of its own to the first part.
inline void add_triangle(model::Mesh& mesh, const std::array<Eigen::Vector3f, 3>& corners) {
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
  mesh.normals.resize(mesh.positions.size(), Eigen::Vector3f(1, 0, 0));
  mesh.uvs.resize(mesh.positions.size(), Eigen::Vector2f(0, 0));
  mesh.parts[0].triangles.push_back({{base, base + 1, base + 2}, 0});
}

// A cube about the origin, with sides of 2 m; each side has two triangles, whose normals point
// outwards. Each triangle has vertices of its own, as in meshes with hard edges.
inline model::Mesh cube() {
  model::Mesh mesh;
  mesh.materials.emplace_back();
  mesh.parts.push_back({.name = "cube"});
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0F, 1.0F}) {
      const auto at = [&](float u, float v) {
        Eigen::Vector3f p;
        p[axis] = side;
        p[(axis + 1) % 3] = u;
        p[(axis + 2) % 3] = side * v;
        return p;
      };
      add_triangle(mesh, {at(-1, -1), at(1, -1), at(1, 1)});
      add_triangle(mesh, {at(-1, -1), at(1, 1), at(-1, 1)});
    }
  return mesh;
}

inline void turn(model::Triangle& triangle) { std::swap(triangle.vertex[0], triangle.vertex[1]); }

}  // namespace airtruth::shade
