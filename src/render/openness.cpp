// SPDX-License-Identifier: Apache-2.0
#include "render/openness.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <tbb/parallel_for.h>

namespace airtruth::render {
namespace {

constexpr std::size_t kMostRays = 1'500'000;  // of a model: under a second on two cores
constexpr std::size_t kMostDirections = 64;   // of a corner: 1/64 of all light is one step
constexpr std::size_t kFewestDirections = 8;
constexpr float kInset = 0.25f;   // from a corner towards the triangle's middle, as a share
constexpr float kStartM = 0.02f;  // above the surface: files draw markings a centimetre above skins
constexpr float kReachM = 60.0f;  // longer than any aircraft's half
constexpr float kInside = 0.1f;   // a side that is less open is likely the inside of a skin

// Directions about +z, distributed by cosine: Hammersley's points (Halton 1960) through Malley's
// method.
std::vector<Eigen::Vector3f> directions(std::size_t count) {
  std::vector<Eigen::Vector3f> result;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t bits = static_cast<std::uint32_t>(i);
    float radical = 0;
    for (float half = 0.5f; bits != 0; bits >>= 1, half /= 2)
      if ((bits & 1) != 0) radical += half;
    const float r2 = (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
    const float r = std::sqrt(r2);
    const float angle = 2 * static_cast<float>(kPi) * radical;
    result.emplace_back(r * std::cos(angle), r * std::sin(angle), std::sqrt(1 - r2));
  }
  return result;
}

// Two axes across a unit normal (Duff et al. 2017).
std::array<Eigen::Vector3f, 2> axes_across(const Eigen::Vector3f& n) {
  const float sign = std::copysign(1.0f, n.z());
  const float a = -1 / (sign + n.z());
  const float b = n.x() * n.y() * a;
  return {Eigen::Vector3f(1 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()),
          Eigen::Vector3f(b, sign + n.y() * n.y() * a, -n.y())};
}

float open_share(const Model::Impl& model,
                 const Eigen::Vector3f& point,
                 const Eigen::Vector3f& normal,
                 std::span<const Eigen::Vector3f> about_z) {
  const auto [x, y] = axes_across(normal);
  const Eigen::Vector3f origin = point + kStartM * normal;
  std::size_t open = 0;
  for (const Eigen::Vector3f& d : about_z)
    if (!is_blocked(model, origin, d.x() * x + d.y() * y + d.z() * normal, kReachM)) ++open;
  return static_cast<float>(open) / static_cast<float>(about_z.size());
}

TriangleOpenness openness_of_triangle(const Model::Impl& model,
                                      const aircraft::Triangle& triangle,
                                      std::span<const Eigen::Vector3f> about_z) {
  TriangleOpenness result;
  std::array<Eigen::Vector3f, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) corners[i] = model.mesh.positions[triangle.vertex[i]];
  Eigen::Vector3f face = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  if (!(face.norm() > 1e-9f)) return result;
  face.normalize();
  const Eigen::Vector3f middle = (corners[0] + corners[1] + corners[2]) / 3;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3f point = corners[i] + kInset * (middle - corners[i]);
    result.front[i] = open_share(model, point, face, about_z);
    result.back[i] =
        result.front[i] < kInside ? open_share(model, point, -face, about_z) : result.front[i];
  }
  return result;
}

}  // namespace

Openness openness_of(const Model::Impl& model) {
  std::size_t corners = 1;
  for (const aircraft::Part& part : model.mesh.parts) corners += 3 * part.triangles.size();
  const std::vector<Eigen::Vector3f> about_z =
      directions(std::clamp(kMostRays / corners, kFewestDirections, kMostDirections));
  Openness result;
  for (const aircraft::Part& part : model.mesh.parts) {
    std::vector<TriangleOpenness>& values = result.emplace_back(part.triangles.size());
    if (part.spins) continue;
    tbb::parallel_for(std::size_t{0}, values.size(), [&](std::size_t i) {
      values[i] = openness_of_triangle(model, part.triangles[i], about_z);
    });
  }
  return result;
}

}  // namespace airtruth::render
