// SPDX-License-Identifier: Apache-2.0
#include "aircraft/wrapper/tidy.h"

#include <algorithm>
#include <array>
#include <set>

namespace airtruth::aircraft {
namespace {

void drop_doubles(Mesh& mesh) {
  for (Part& part : mesh.parts) {
    std::set<std::array<std::array<float, 3>, 3>> seen;
    std::erase_if(part.triangles, [&](const Triangle& triangle) {
      std::array<std::array<float, 3>, 3> key;
      for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::Vector3f& p = mesh.positions[triangle.vertex[i]];
        key[i] = {p.x(), p.y(), p.z()};
      }
      const Eigen::Vector3f a =
          mesh.positions[triangle.vertex[1]] - mesh.positions[triangle.vertex[0]];
      const Eigen::Vector3f b =
          mesh.positions[triangle.vertex[2]] - mesh.positions[triangle.vertex[0]];
      if (!(a.cross(b).norm() > 1e-10f)) return true;
      std::sort(key.begin(), key.end());
      return !seen.insert(key).second;
    });
  }
}

// Removes vertices that no triangle uses.
void drop_unused(Mesh& mesh) {
  constexpr std::uint32_t kUnused = ~std::uint32_t{0};
  std::vector<std::uint32_t> new_from_old(mesh.positions.size(), kUnused);
  Mesh kept;
  for (Part& part : mesh.parts) {
    for (Triangle& triangle : part.triangles) {
      for (std::uint32_t& vertex : triangle.vertex) {
        std::uint32_t& moved = new_from_old[vertex];
        if (moved == kUnused) {
          moved = static_cast<std::uint32_t>(kept.positions.size());
          kept.positions.push_back(mesh.positions[vertex]);
          kept.normals.push_back(mesh.normals[vertex]);
          kept.uvs.push_back(mesh.uvs[vertex]);
        }
        vertex = moved;
      }
    }
  }
  mesh.positions = std::move(kept.positions);
  mesh.normals = std::move(kept.normals);
  mesh.uvs = std::move(kept.uvs);
}

}  // namespace

void tidy(Mesh& mesh) {
  drop_doubles(mesh);
  drop_unused(mesh);
  if (mesh.parts.size() > 1)
    mesh.parts.erase(std::remove_if(mesh.parts.begin() + 1,
                                    mesh.parts.end(),
                                    [](const Part& part) { return part.triangles.empty(); }),
                     mesh.parts.end());
}

}  // namespace airtruth::aircraft
