// SPDX-License-Identifier: Apache-2.0
#include "aircraft/shapes/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "foundation/base/error.h"
#include "foundation/geometry/transform.h"

namespace airtruth::shapes {
namespace {

// Height of the surface of a lens-shaped section along its chord, as a share of its thickness.
struct ChordPoint {
  float along;
  float height;
};
constexpr std::array<ChordPoint, 4> kSection = {{{0, 0}, {0.15f, 0.42f}, {0.45f, 0.5f}, {1, 0}}};

// Cosine or sine of a corner's angle, drawn out towards the corners of a box.
float drawn_out(float x, float squareness) {
  return squareness == 2 ? x : std::copysign(std::pow(std::abs(x), 2 / squareness), x);
}

}  // namespace

std::uint32_t MeshBuilder::add_material(const std::array<float, 3>& linear_rgb,
                                        model::Finish finish) {
  model::Material material;
  material.diffuse = linear_rgb;
  material.finish = finish;
  mesh_.materials.push_back(material);
  return static_cast<std::uint32_t>(mesh_.materials.size() - 1);
}

void MeshBuilder::begin_part(model::Part part) { mesh_.parts.push_back(std::move(part)); }

void MeshBuilder::add_body(std::span<const Ring> rings,
                           const Eigen::Vector3f& across,
                           const Eigen::Vector3f& along,
                           int sides,
                           std::uint32_t material) {
  check(rings.size() >= 2 && sides >= 3, "a body has two rings of three corners");
  std::vector<std::vector<std::uint32_t>> corners;
  for (const Ring& ring : rings) {
    std::vector<std::uint32_t>& of_ring = corners.emplace_back();
    for (int k = 0; k < sides; ++k) {
      const auto angle =
          2 * static_cast<float>(kPi) * static_cast<float>(k) / static_cast<float>(sides);
      of_ring.push_back(add_vertex(
          ring.centre + ring.half_width * drawn_out(std::cos(angle), ring.squareness) * across +
          ring.half_height * drawn_out(std::sin(angle), ring.squareness) * along));
    }
  }
  // Corners turn counter-clockwise seen from outside, whichever way the rings follow each other.
  const bool goes_back = across.cross(along).dot(rings.back().centre - rings.front().centre) < 0;
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (goes_back)
      add_triangle(a, c, b, material);
    else
      add_triangle(a, b, c, material);
  };
  const auto next = [&](std::size_t k) { return (k + 1) % static_cast<std::size_t>(sides); };
  for (std::size_t r = 0; r + 1 < corners.size(); ++r)
    for (std::size_t k = 0; k < corners[r].size(); ++k) {
      add(corners[r][k], corners[r][next(k)], corners[r + 1][next(k)]);
      add(corners[r][k], corners[r + 1][next(k)], corners[r + 1][k]);
    }
  const std::uint32_t first = add_vertex(rings.front().centre);
  const std::uint32_t last = add_vertex(rings.back().centre);
  for (std::size_t k = 0; k < corners.front().size(); ++k) {
    add(first, corners.front()[next(k)], corners.front()[k]);
    add(last, corners.back()[k], corners.back()[next(k)]);
  }
}

void MeshBuilder::add_tube(const Eigen::Vector3f& from,
                           const Eigen::Vector3f& to,
                           float radius,
                           int sides,
                           std::uint32_t material) {
  const Eigen::Vector3f axis = (to - from).normalized();
  const Eigen::Vector3f other =
      std::abs(axis.z()) < 0.9f ? Eigen::Vector3f(0, 0, 1) : Eigen::Vector3f(1, 0, 0);
  const Eigen::Vector3f across = axis.cross(other).normalized();
  const std::array<Ring, 2> ends = {Ring{from, radius, radius}, Ring{to, radius, radius}};
  add_body(ends, across, axis.cross(across), sides, material);
}

void MeshBuilder::add_box(const Eigen::Vector3f& low,
                          const Eigen::Vector3f& high,
                          std::uint32_t material) {
  // Each side has corners of its own, so that its normals are those of the side.
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    for (const bool is_high : {false, true}) {
      std::array<std::uint32_t, 4> corner{};
      for (std::size_t k = 0; k < 4; ++k) {
        Eigen::Vector3f p = low;
        p[axis] = is_high ? high[axis] : low[axis];
        if (k == 1 || k == 2) p[u] = high[u];
        if (k >= 2) p[v] = high[v];
        corner[k] = add_vertex(p);
      }
      if (is_high)
        add_quad(corner[0], corner[1], corner[2], corner[3], material);
      else
        add_quad(corner[3], corner[2], corner[1], corner[0], material);
    }
  }
}

void MeshBuilder::add_wing(std::span<const Rib> ribs,
                           std::uint32_t upper,
                           std::uint32_t lower,
                           const Eigen::Vector3f& above) {
  check(ribs.size() >= 2, "a wing has two ribs");
  const Rib& widest = *std::max_element(ribs.begin(), ribs.end(), [](const Rib& a, const Rib& b) {
    return (a.leading - a.trailing).squaredNorm() < (b.leading - b.trailing).squaredNorm();
  });
  // Seen from outside the corners turn one way, whichever side the wing is on.
  const bool is_right = (widest.leading - widest.trailing)
                            .cross(ribs.back().leading - ribs.front().leading)
                            .dot(above) < 0;
  for (const float side : {1.0f, -1.0f}) {
    std::vector<std::array<std::uint32_t, kSection.size()>> points;
    for (const Rib& rib : ribs) {
      auto& of_rib = points.emplace_back();
      for (std::size_t k = 0; k < kSection.size(); ++k)
        of_rib[k] = add_vertex(rib.leading + kSection[k].along * (rib.trailing - rib.leading) +
                               side * kSection[k].height * rib.thickness * above);
    }
    for (std::size_t r = 0; r + 1 < points.size(); ++r)
      for (std::size_t k = 0; k + 1 < kSection.size(); ++k) {
        const auto& [a, b] = std::pair(points[r], points[r + 1]);
        const std::uint32_t material = side > 0 ? upper : lower;
        if ((side > 0) != is_right)
          add_quad(a[k], b[k], b[k + 1], a[k + 1], material);
        else
          add_quad(a[k + 1], b[k + 1], b[k], a[k], material);
      }
  }
}

void MeshBuilder::cut(std::size_t first, const Eigen::Hyperplane<float, 3>& plane) {
  // A corner that is as near lies on the plane; there is no sliver to cut off. Chosen.
  constexpr float kOnPlaneM = 1e-4f;
  const auto distance = [&](std::uint32_t v) {
    const float d = plane.signedDistance(mesh_.positions[v]);
    return std::abs(d) < kOnPlaneM ? 0 : d;
  };
  // Neighbours share the corner on their common side, so that a closed skin stays closed.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> corners;
  const auto corner_between = [&](std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    const auto [known, is_new] = corners.try_emplace({a, b}, 0);
    const float share = distance(a) / (distance(a) - distance(b));
    const Eigen::Vector3f at = (1 - share) * mesh_.positions[a] + share * mesh_.positions[b];
    if (is_new) known->second = add_vertex(at);
    return known->second;
  };
  std::vector<model::Triangle>& triangles = mesh_.parts.back().triangles;
  std::vector<model::Triangle> pieces;
  for (std::size_t i = first; i < triangles.size(); ++i) {
    std::array<std::vector<std::uint32_t>, 2> sides;
    bool is_cut = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[i].vertex[k], b = triangles[i].vertex[(k + 1) % 3];
      if (distance(a) >= 0) sides[0].push_back(a);
      if (distance(a) <= 0) sides[1].push_back(a);
      if (distance(a) * distance(b) >= 0) continue;
      is_cut = true;
      for (auto& side : sides) side.push_back(corner_between(a, b));
    }
    if (!is_cut) pieces.push_back(triangles[i]);
    for (const auto& side : sides)
      for (std::size_t k = 2; is_cut && k < side.size(); ++k)
        pieces.push_back({{side[0], side[k - 1], side[k]}, triangles[i].material});
  }
  triangles.resize(first);
  triangles.insert(triangles.end(), pieces.begin(), pieces.end());
}

void MeshBuilder::paint(std::size_t first,
                        std::uint32_t material,
                        const std::function<bool(const Eigen::Vector3f&)>& is_wanted) {
  std::vector<model::Triangle>& triangles = mesh_.parts.back().triangles;
  for (std::size_t i = first; i < triangles.size(); ++i) {
    Eigen::Vector3f middle(0, 0, 0);
    for (const std::uint32_t v : triangles[i].vertex) middle += mesh_.positions[v] / 3;
    if (is_wanted(middle)) triangles[i].material = material;
  }
}

model::Mesh MeshBuilder::take() {
  mesh_.normals.assign(mesh_.positions.size(), Eigen::Vector3f::Zero());
  for (const model::Part& part : mesh_.parts)
    for (const model::Triangle& triangle : part.triangles) {
      const auto& [a, b, c] = triangle.vertex;
      // Its length is twice the triangle's area: large triangles weigh more.
      const Eigen::Vector3f face =
          (mesh_.positions[b] - mesh_.positions[a]).cross(mesh_.positions[c] - mesh_.positions[a]);
      for (const std::uint32_t v : triangle.vertex) mesh_.normals[v] += face;
    }
  for (Eigen::Vector3f& normal : mesh_.normals)
    normal = normal.norm() > 0 ? normal.normalized() : Eigen::Vector3f(0, 0, -1);
  return std::move(mesh_);
}

std::uint32_t MeshBuilder::add_vertex(const Eigen::Vector3f& position) {
  mesh_.positions.push_back(position);
  mesh_.uvs.emplace_back(0, 0);
  return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
}

void MeshBuilder::add_triangle(std::uint32_t a,
                               std::uint32_t b,
                               std::uint32_t c,
                               std::uint32_t material) {
  const Eigen::Vector3f across =
      (mesh_.positions[b] - mesh_.positions[a]).cross(mesh_.positions[c] - mesh_.positions[a]);
  // A ring that shrinks to a point leaves triangles without an area.
  if (!(across.squaredNorm() > 0)) return;
  mesh_.parts.back().triangles.push_back({{a, b, c}, material});
}

void MeshBuilder::add_quad(
    std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, std::uint32_t material) {
  add_triangle(a, b, c, material);
  add_triangle(a, c, d, material);
}

}  // namespace airtruth::shapes
