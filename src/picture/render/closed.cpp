// SPDX-License-Identifier: Apache-2.0
#include "picture/render/closed.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

namespace airtruth::render {
namespace {

constexpr std::uint32_t kNoSurface = std::numeric_limits<std::uint32_t>::max();

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

// A side of a triangle.
struct Side {
  // Of its two points, the smaller first.
  std::uint64_t points;
  std::uint32_t triangle;
  // 1 where the triangle passes it from the smaller point to the larger, else -1.
  std::int8_t direction;
};

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

// Calls use(first, last) for the sides between the same two points.
template <typename Use>
void for_each_side(const std::vector<Side>& sides, const Use& use) {
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last = std::find_if(
        first, sides.end(), [&](const Side& side) { return side.points != first->points; });
    use(first, last);
    first = last;
  }
}

// The surfaces of a part.
struct Surfaces {
  // By triangle: its surface, and whether its direction of rotation is kept (1) or turned (-1).
  std::vector<std::uint32_t> of;
  std::vector<std::int8_t> sign;
  std::uint32_t count = 0;
};

Surfaces connect(const std::vector<Side>& sides, std::size_t triangles) {
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
  Surfaces surfaces{std::vector<std::uint32_t>(triangles, kNoSurface),
                    std::vector<std::int8_t>(triangles, 0)};
  std::vector<std::uint32_t> open;
  for (const Side& side : sides) {
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

// By surface: true where every side is passed as often one way as the other.
std::vector<bool> are_closed(const std::vector<Side>& sides, const Surfaces& surfaces) {
  std::vector<bool> closed(surfaces.count, true);
  std::vector<std::pair<std::uint32_t, int>> passes;  // surface, direction
  for_each_side(sides, [&](auto first, auto last) {
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
                                    const std::vector<std::uint8_t>& opaque,
                                    const std::vector<std::uint32_t>& points) {
  // A cubic centimetre: a surface that encloses less is a sheet with two sides.
  constexpr double kLeastVolumeM3 = 1e-6;
  const std::vector<Side> sides = sides_of(part, points);
  const Surfaces surfaces = connect(sides, part.triangles.size());
  std::vector<bool> closed = are_closed(sides, surfaces);
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
    const aircraft::Mesh& mesh, const std::vector<std::vector<std::uint8_t>>& opaque) {
  const std::vector<std::uint32_t> points = points_of(mesh);
  std::vector<std::vector<std::int8_t>> outward;
  for (std::size_t p = 0; p < mesh.parts.size(); ++p)
    outward.push_back(outward_of(mesh, mesh.parts[p], opaque[p], points));
  return outward;
}

void leave_open_insides(const Model::Impl& model, std::vector<std::vector<std::int8_t>>& outward) {
  for (std::size_t p = 0; p < outward.size(); ++p)
    for (std::size_t t = 0; t < outward[p].size(); ++t) {
      const TriangleOpenness& both = model.openness[p][t];
      for (const Openness& inside : (outward[p][t] > 0 ? both.back : both.front).corner)
        if (inside.share > 0) outward[p][t] = 0;
    }
}

FacingAway::FacingAway(const aircraft::Mesh& mesh,
                       const aircraft::Part& part,
                       const std::vector<std::int8_t>& outward,
                       std::vector<Vector3> eye_in_part)
    : mesh_(mesh), part_(part), outward_(outward), eye_in_part_(std::move(eye_in_part)) {}

bool FacingAway::operator()(std::size_t triangle) const {
  // Sine of the angle between a line of sight and a triangle's plane below which rounding decides
  // which side is seen.
  constexpr double kEdgeOn = 1e-6;
  if (outward_[triangle] == 0) return false;
  const auto& [a, b, c] = part_.triangles[triangle].vertex;
  const Vector3 p = mesh_.positions[a].cast<double>();
  const Vector3 normal =
      outward_[triangle] *
      (mesh_.positions[b].cast<double>() - p).cross(mesh_.positions[c].cast<double>() - p);
  std::array<double, 3> height{};
  double most = -std::numeric_limits<double>::infinity();
  double reach = 0;
  for (std::size_t k = 0; k < eye_in_part_.size(); ++k) {
    const Vector3 to_eye = eye_in_part_[k] - p;
    height[k] = normal.dot(to_eye);
    most = std::max(most, height[k]);
    reach = std::max(reach, to_eye.norm());
  }
  // A parabola goes at most an eighth of the second difference beyond its values.
  if (eye_in_part_.size() > 1) most += std::abs(height[0] - 2 * height[1] + height[2]) / 8;
  return most < -kEdgeOn * normal.norm() * reach;
}

}  // namespace airtruth::render
