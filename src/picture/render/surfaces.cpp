// SPDX-License-Identifier: Apache-2.0
#include "picture/render/surfaces.h"

#include <array>
#include <bit>
#include <numeric>
#include <tuple>
#include <utility>

namespace airtruth::render {
namespace {

// A number for each position of the mesh; equal positions have the same one.
std::vector<std::uint32_t> points_of(const aircraft::Mesh& mesh) {
  // Bits have an order whatever the numbers are; adding 0 turns -0 into 0.
  const auto key = [&](std::uint32_t i) {
    const Eigen::Vector3f& p = mesh.positions[i];
    const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x + 0.0F); };
    return std::tuple(bits(p.x()), bits(p.y()), bits(p.z()));
  };
  std::vector<std::uint32_t> order(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return key(a) < key(b);
  });
  std::vector<std::uint32_t> points(order.size());
  std::uint32_t last = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && key(order[i - 1]) < key(order[i])) ++last;
    points[order[i]] = last;
  }
  return points;
}

// The sides of all triangles with three different corners; equal ones follow one another.
std::vector<Side> sides_of(const aircraft::Part& part, const std::vector<std::uint32_t>& points) {
  std::vector<Side> sides;
  sides.reserve(3 * part.triangles.size());
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    std::array<std::uint32_t, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = points[part.triangles[t].vertex[k]];
    if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t from = p[k];
      const std::uint64_t to = p[(k + 1) % 3];
      sides.push_back({std::min(from, to) << 32 | std::max(from, to),
                       static_cast<std::uint32_t>(t),
                       static_cast<std::int8_t>(from < to ? 1 : -1)});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::pair(a.points, a.triangle) < std::pair(b.points, b.triangle);
  });
  return sides;
}

Surfaces connected(std::vector<Side> sides, std::size_t triangles) {
  struct Neighbour {
    std::uint32_t triangle;
    std::int8_t sign;
  };
  std::vector<std::array<Neighbour, 3>> neighbours(triangles);
  std::vector<std::uint8_t> known(triangles, 0);
  for_each_side(sides, [&](auto first, auto last) {
    if (last - first != 2) return;
    const Side& a = first[0];
    const Side& b = first[1];
    const auto sign = static_cast<std::int8_t>(-a.direction * b.direction);
    neighbours[a.triangle][known[a.triangle]++] = {b.triangle, sign};
    neighbours[b.triangle][known[b.triangle]++] = {a.triangle, sign};
  });
  Surfaces surfaces{std::move(sides),
                    std::vector<std::uint32_t>(triangles, kNoSurface),
                    std::vector<std::int8_t>(triangles, 0)};
  std::vector<std::uint32_t> open;
  for (const Side& side : surfaces.sides) {
    if (surfaces.of[side.triangle] != kNoSurface) continue;
    open.assign(1, side.triangle);
    surfaces.of[side.triangle] = surfaces.count;
    surfaces.sign[side.triangle] = 1;
    while (!open.empty()) {
      const std::uint32_t t = open.back();
      open.pop_back();
      for (std::size_t k = 0; k < known[t]; ++k) {
        const Neighbour& next = neighbours[t][k];
        if (surfaces.of[next.triangle] != kNoSurface) continue;
        surfaces.of[next.triangle] = surfaces.count;
        surfaces.sign[next.triangle] = static_cast<std::int8_t>(surfaces.sign[t] * next.sign);
        open.push_back(next.triangle);
      }
    }
    ++surfaces.count;
  }
  return surfaces;
}

}  // namespace

std::vector<Surfaces> surfaces_of(const aircraft::Mesh& mesh) {
  const std::vector<std::uint32_t> points = points_of(mesh);
  std::vector<Surfaces> surfaces;
  for (const aircraft::Part& part : mesh.parts)
    surfaces.push_back(connected(sides_of(part, points), part.triangles.size()));
  return surfaces;
}

}  // namespace airtruth::render
