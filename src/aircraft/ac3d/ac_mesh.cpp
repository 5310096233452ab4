// SPDX-License-Identifier: Apache-2.0
#include "aircraft/ac3d/ac_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include <Eigen/Geometry>

#include "foundation/geometry/transform.h"

namespace airtruth::ac3d {
namespace {

using Planar = std::array<double, 2>;

double doubled_area(const Planar& a, const Planar& b, const Planar& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// The corners projected along the normal onto two axes, counter-clockwise. The axis in which the
// normal is largest is dropped.
std::vector<Planar> projected(std::span<const Eigen::Vector3f> corners,
                              const Eigen::Vector3f& normal) {
  int away = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(normal[i]) > std::abs(normal[away])) away = i;
  int first = (away + 1) % 3;
  int second = (away + 2) % 3;
  if (normal[away] < 0) std::swap(first, second);
  std::vector<Planar> result;
  for (const Eigen::Vector3f& corner : corners)
    result.push_back({double{corner[first]}, double{corner[second]}});
  return result;
}

// The scalar product, written out so that every compiler adds in the same order and the result is
// the same.
float dot_product(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}

}  // namespace

Eigen::Vector3f area_normal(std::span<const Eigen::Vector3f> corners) {
  Eigen::Vector3f sum(0, 0, 0);
  for (std::size_t i = 2; i < corners.size(); ++i)
    sum += (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]);
  return sum;
}

bool is_concave(std::span<const Eigen::Vector3f> corners) {
  if (corners.size() < 4) return false;
  Eigen::Vector3f sum(0, 0, 0);
  Eigen::Vector3f before(0, 0, 0);  // normal at the corner before
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const Eigen::Vector3f fan = (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]);
    if (dot_product(fan, sum) < 0) return true;
    const Eigen::Vector3f here =
        i == 2 ? fan : (corners[i - 1] - corners[i - 2]).cross(corners[i] - corners[i - 2]);
    if (i > 2 && dot_product(here, before) < 0) return true;
    before = here;
    sum += fan;
  }
  return false;
}

std::vector<std::array<std::uint32_t, 3>> ear_clipped(std::span<const Eigen::Vector3f> corners,
                                                      const Eigen::Vector3f& normal) {
  const std::vector<Planar> flat = projected(corners, normal);
  std::vector<std::uint32_t> left(flat.size());
  std::iota(left.begin(), left.end(), 0u);
  const auto triangle = [&](std::size_t i) {
    const std::size_t n = left.size();
    return std::array{left[(i + n - 1) % n], left[i], left[(i + 1) % n]};
  };
  const auto area_at = [&](std::size_t i) {
    const auto [a, b, c] = triangle(i);
    return doubled_area(flat[a], flat[b], flat[c]);
  };
  const auto is_ear = [&](std::size_t i) {
    const auto [a, b, c] = triangle(i);
    const Planar &pa = flat[a], &pb = flat[b], &pc = flat[c];
    return area_at(i) > 0 && std::ranges::none_of(left, [&](std::uint32_t other) {
             const Planar& p = flat[other];
             return p != pa && p != pb && p != pc && doubled_area(pa, pb, p) >= 0 &&
                    doubled_area(pb, pc, p) >= 0 && doubled_area(pc, pa, p) >= 0;
           });
  };
  const auto next_ear = [&](std::size_t start) {
    const std::size_t n = left.size();
    for (std::size_t k = 0; k < n; ++k)
      if (is_ear((start + k) % n)) return (start + k) % n;
    std::size_t flattest = 0;  // removing a corner of no area changes nothing
    for (std::size_t i = 1; i < n; ++i)
      if (std::abs(area_at(i)) < std::abs(area_at(flattest))) flattest = i;
    return flattest;
  };
  std::vector<std::array<std::uint32_t, 3>> result;
  std::size_t start = 1;  // a polygon that is convex after all becomes a fan
  while (left.size() > 3) {
    const std::size_t ear = next_ear(start);
    result.push_back(triangle(ear));
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
    start = ear % left.size();
  }
  result.push_back({left[0], left[1], left[2]});
  return result;
}

namespace {

float length_of(const Eigen::Vector3f& v) { return std::sqrt(dot_product(v, v)); }

Eigen::Vector3f unit_or_zero(const Eigen::Vector3f& v) {
  const float length = length_of(v);
  return length > 0 ? Eigen::Vector3f(v * (1.0f / length)) : v;
}

enum class Cut { kEars, kTriangle, kQuad, kFan };

struct Facet {
  std::vector<Eigen::Vector3f> positions;
  Eigen::Vector3f weighted_normal{0, 0, 0};
  Cut cut = Cut::kFan;
};

Facet facet_of(const AcObject& object, const AcSurface& surface) {
  Facet facet;
  for (std::uint32_t i = 0; i < surface.corners; ++i)
    facet.positions.push_back(object.vertices[object.corners[surface.first_corner + i].vertex]);
  facet.weighted_normal = area_normal(facet.positions);
  facet.cut = is_concave(facet.positions) ? Cut::kEars
              : surface.corners == 3      ? Cut::kTriangle
              : surface.corners == 4      ? Cut::kQuad
                                          : Cut::kFan;
  return facet;
}

// A corner of a smooth surface, listed at the vertex that it shares with other corners.
struct Meeting {
  std::uint32_t corner = 0;
  Eigen::Vector3f normal{0, 0, 0};  // weighted by area
  float length = 0;
};

// Averages the normals of corners that are linked by less than the crease angle, set by set.
void smooth_vertex(std::vector<Meeting>& meetings,
                   float cos_crease,
                   std::vector<Eigen::Vector3f>& normal_of_corner) {
  const std::size_t count = meetings.size();
  std::vector<bool> taken(count, false);
  std::vector<std::size_t> set;
  for (std::size_t first = 0; first < count; ++first) {
    if (taken[first]) continue;
    set.assign(1, first);
    taken[first] = true;
    for (std::size_t at = 0; at < set.size(); ++at) {
      const Meeting& a = meetings[set[at]];
      for (std::size_t i = 0; i < count; ++i) {
        if (taken[i]) continue;
        const Meeting& b = meetings[i];
        if (!(cos_crease * (b.length * a.length) <= dot_product(b.normal, a.normal))) continue;
        taken[i] = true;
        set.push_back(i);
      }
    }
    std::sort(set.begin(), set.end());
    Eigen::Vector3f sum(0, 0, 0);
    for (const std::size_t i : set) sum += meetings[i].normal;
    const Eigen::Vector3f normal = unit_or_zero(sum);
    for (const std::size_t i : set) normal_of_corner[meetings[i].corner] = normal;
  }
}

float cosine_of_crease(float crease_deg) {
  if (crease_deg <= 0) return 1;
  return std::cos(static_cast<float>(radians(static_cast<double>(crease_deg))));
}

std::vector<Eigen::Vector3f> corner_normals(const AcObject& object,
                                            const std::vector<Facet>& facets) {
  std::vector<Eigen::Vector3f> result(object.corners.size(), Eigen::Vector3f::Zero());
  std::vector<std::uint32_t> first(object.vertices.size() + 1, 0);  // of each vertex's meetings
  for (const AcSurface& surface : object.surfaces)
    for (std::uint32_t i = 0; surface.smooth && i < surface.corners; ++i)
      ++first[object.corners[surface.first_corner + i].vertex + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> next(first.begin(), first.end());
  std::vector<Meeting> sorted(first.back());
  for (std::size_t s = 0; s < object.surfaces.size(); ++s) {
    const AcSurface& surface = object.surfaces[s];
    const Eigen::Vector3f& weighted = facets[s].weighted_normal;
    for (std::uint32_t i = 0; i < surface.corners; ++i) {
      const std::uint32_t corner = surface.first_corner + i;
      if (surface.smooth) {
        sorted[next[object.corners[corner].vertex]++] = {corner, weighted, length_of(weighted)};
      } else {
        result[corner] = unit_or_zero(weighted);
      }
    }
  }
  const float cos_crease = cosine_of_crease(object.crease_deg);
  std::vector<Meeting> here;
  for (std::size_t v = 0; v + 1 < first.size(); ++v) {
    here.assign(sorted.begin() + first[v], sorted.begin() + first[v + 1]);
    smooth_vertex(here, cos_crease, result);
  }
  return result;
}

// A vertex by the bits of its position, normal and texture coordinates.
using VertexBits = std::array<std::uint32_t, 8>;

struct VertexHash {
  std::size_t operator()(const VertexBits& bits) const {
    std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a
    for (const std::uint32_t word : bits) hash = (hash ^ word) * 0x100000001b3u;
    return static_cast<std::size_t>(hash ^ (hash >> 29));
  }
};

void add_triangles(const Facet& facet,
                   const std::vector<std::uint32_t>& vertices,
                   std::vector<std::array<std::uint32_t, 3>>& triangles) {
  if (facet.cut == Cut::kEars) {
    for (const auto& [a, b, c] : ear_clipped(facet.positions, facet.weighted_normal))
      triangles.push_back({vertices[a], vertices[b], vertices[c]});
    return;
  }
  for (std::size_t i = 2; i < vertices.size(); ++i)
    triangles.push_back({vertices[0], vertices[i - 1], vertices[i]});
}

// Sorts surfaces by material, then smooth before flat, two-sided before one-sided, then by their
// cut. The order matters, because of triangles in the same place only the first is kept.
std::vector<std::size_t> drawing_order(const AcObject& object, const std::vector<Facet>& facets) {
  std::vector<std::size_t> order(object.surfaces.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto key = [&](std::size_t i) {
    const AcSurface& surface = object.surfaces[i];
    return std::tuple(surface.material, !surface.smooth, !surface.two_sided, facets[i].cut);
  };
  std::stable_sort(
      order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  return order;
}

}  // namespace

std::vector<Batch> batches_of(const AcFile& file, const AcObject& object) {
  std::vector<Facet> facets;
  facets.reserve(object.surfaces.size());
  for (const AcSurface& surface : object.surfaces) facets.push_back(facet_of(object, surface));
  const std::vector<Eigen::Vector3f> normals = corner_normals(object, facets);
  std::vector<Batch> result;
  std::unordered_map<VertexBits, std::uint32_t, VertexHash> index;  // of the last batch's vertices
  const auto vertex = [&](const Eigen::Vector3f& position, std::uint32_t corner_index) {
    Batch& batch = result.back();
    const AcCorner& corner = object.corners[corner_index];
    const Eigen::Vector3f& normal = normals[corner_index];
    const Eigen::Vector2f uv =
        object.texture.empty() ? Eigen::Vector2f(0, 0) : Eigen::Vector2f(corner.u, corner.v);
    std::array<float, 8> values{};
    Eigen::Map<Eigen::Matrix<float, 8, 1>>(values.data()) << position, normal, uv;
    const auto [known, is_new] = index.try_emplace(
        std::bit_cast<VertexBits>(values), static_cast<std::uint32_t>(batch.positions.size()));
    if (is_new) {
      batch.positions.push_back(position);
      batch.normals.push_back(normal);
      batch.uvs.push_back(uv);
    }
    return known->second;
  };
  std::optional<std::uint32_t> material;
  for (const std::size_t i : drawing_order(object, facets)) {
    const AcSurface& surface = object.surfaces[i];
    if (material != surface.material) {
      material = surface.material;
      index.clear();
      Batch& batch = result.emplace_back();
      batch.srgb = file.materials[surface.material];
      batch.texture = object.texture;
      batch.texture_line = object.texture_line;
    }
    std::vector<std::uint32_t> vertices;
    for (std::uint32_t k = 0; k < surface.corners; ++k)
      vertices.push_back(vertex(facets[i].positions[k], surface.first_corner + k));
    add_triangles(facets[i], vertices, result.back().triangles);
  }
  return result;
}

}  // namespace airtruth::ac3d
