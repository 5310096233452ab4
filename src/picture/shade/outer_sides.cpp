// SPDX-License-Identifier: Apache-2.0
#include "picture/shade/outer_sides.h"

#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "foundation/geometry/transform.h"

namespace airtruth::shade {
namespace {

// A number for each position of the mesh; equal positions have the same one.
std::vector<std::uint32_t> points_of(const model::Mesh& mesh) {
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
std::vector<Side> sides_of(const model::Part& part, const std::vector<std::uint32_t>& points) {
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

std::vector<Surfaces> surfaces_of(const model::Mesh& mesh) {
  const std::vector<std::uint32_t> points = points_of(mesh);
  std::vector<Surfaces> surfaces;
  for (const model::Part& part : mesh.parts)
    surfaces.push_back(connected(sides_of(part, points), part.triangles.size()));
  return surfaces;
}

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
std::vector<double> volumes_m3(const model::Mesh& mesh,
                               const model::Part& part,
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

std::vector<std::int8_t> outward_of(const model::Mesh& mesh,
                                    const model::Part& part,
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
    const model::Mesh& mesh,
    const std::vector<Surfaces>& surfaces,
    const std::vector<std::vector<std::uint8_t>>& opaque) {
  std::vector<std::vector<std::int8_t>> outward;
  for (std::size_t p = 0; p < mesh.parts.size(); ++p)
    outward.push_back(outward_of(mesh, mesh.parts[p], surfaces[p], opaque[p]));
  return outward;
}

namespace {

OuterSides both_of(OuterSides a, OuterSides b) { return static_cast<OuterSides>(a | b); }

OuterSides turned(OuterSides sides) {
  if (sides == kFrontSide) return kBackSide;
  return sides == kBackSide ? kFrontSide : sides;
}

bool sees_open(const SideOcclusion& side) {
  return std::any_of(side.corner.begin(), side.corner.end(), [](const AmbientOcclusion& corner) {
    return corner.open_share > 0;
  });
}

// The sides of a triangle from which a ray leaves the aircraft.
OuterSides open_sides(const TriangleOcclusion& occlusion) {
  return both_of(sees_open(occlusion.front) ? kFrontSide : kNoSide,
                 sees_open(occlusion.back) ? kBackSide : kNoSide);
}

// By surface: the sides from which a ray leaves the aircraft at any of its triangles. The front is
// that of a triangle whose sign in `surfaces` is 1. A surface that has one side only has both.
std::vector<OuterSides> open_sides_of(const Surfaces& surfaces,
                                      const std::vector<TriangleOcclusion>& occlusion) {
  std::vector<OuterSides> open(surfaces.count, kNoSide);
  for (std::size_t t = 0; t < surfaces.of.size(); ++t) {
    if (surfaces.of[t] == kNoSurface) continue;
    const OuterSides own = open_sides(occlusion[t]);
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
                                 const std::vector<TriangleOcclusion>& occlusion,
                                 bool is_opaque) {
  const std::vector<OuterSides> of_surface = open_sides_of(surfaces, occlusion);
  std::vector<OuterSides> outer(surfaces.of.size(), kBothSides);
  for (std::size_t t = 0; t < outer.size(); ++t) {
    if (surfaces.of[t] == kNoSurface) continue;
    // The ambient occlusion does not say what is visible through a pane.
    OuterSides possible = is_opaque ? of_surface[surfaces.of[t]] : kBothSides;
    if (surfaces.sign[t] < 0) possible = turned(possible);
    if (outward[t] == 0) {
      outer[t] = possible;
    } else {
      const OuterSides out = outward[t] > 0 ? kFrontSide : kBackSide;
      outer[t] = both_of(static_cast<OuterSides>(out & possible), open_sides(occlusion[t]));
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
    outer.push_back(outer_of(surfaces[p], outward[p], model.occlusion[p], is_opaque));
  return outer;
}

bool is_hidden(OuterSides outer, std::span<const double> front_to_eye, double scale) {
  // Sine of the angle between a line of sight and a triangle's plane below which rounding decides
  // which side is visible.
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

}  // namespace airtruth::shade
