// SPDX-License-Identifier: Apache-2.0
#include "picture/render/openness.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <tbb/parallel_for.h>

namespace airtruth::render {
namespace {

// Rays for a whole model, which take under a second on two cores.
constexpr std::size_t kMaxRays = 1'500'000;
// Directions for each corner: one step is 1/64 of all light.
constexpr std::size_t kMaxDirections = 64;
constexpr std::size_t kMinDirections = 8;
// Divisor of the number of directions for insides and for reflected light.
constexpr std::size_t kFewer = 4;
// A side with a smaller open share is probably the inside of a skin.
constexpr float kInside = 0.1f;
// Distance from a corner towards the triangle's middle, as a share.
constexpr float kInset = 0.25f;
// Start of a ray above the surface: model files draw markings a centimetre above skins.
constexpr float kStartM = 0.02f;
// Albedo of the hiding parts: a light paint.
constexpr float kOwnPaint = 0.6f;
// From this open share on, nothing counts as hidden.
constexpr float kNothingHidden = 0.999f;
// Reach of a ray, which exceeds half the length of any aircraft.
constexpr float kReachM = 60.0f;

// Directions about +z with a cosine distribution: Hammersley's points (Halton 1960) mapped by
// Malley's method.
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

// Two axes perpendicular to a unit normal (Duff et al. 2017).
std::array<Eigen::Vector3f, 2> axes_across(const Eigen::Vector3f& n) {
  const float sign = std::copysign(1.0f, n.z());
  const float a = -1 / (sign + n.z());
  const float b = n.x() * n.y() * a;
  return {Eigen::Vector3f(1 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()),
          Eigen::Vector3f(b, sign + n.y() * n.y() * a, -n.y())};
}

Eigen::Vector3f face_of(const aircraft::Mesh& mesh, const aircraft::Triangle& triangle) {
  const auto& [a, b, c] = triangle.vertex;
  const Eigen::Vector3f face =
      (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
  return face / face.norm();
}

// A point slightly above a side of a triangle.
struct Place {
  Eigen::Vector3f point;
  Eigen::Vector3f normal;
  std::array<Eigen::Vector3f, 2> across;

  Place(const Eigen::Vector3f& on_surface, const Eigen::Vector3f& unit_normal)
      : point(on_surface + kStartM * unit_normal),
        normal(unit_normal),
        across(axes_across(unit_normal)) {}
  Eigen::Vector3f direction(const Eigen::Vector3f& about_z) const {
    return about_z.x() * across[0] + about_z.y() * across[1] + about_z.z() * normal;
  }
};

Openness openness_at(const Model::Impl& model,
                     const Place& place,
                     std::span<const Eigen::Vector3f> about_z) {
  std::size_t open = 0;
  Eigen::Vector3f towards(0, 0, 0);
  for (const Eigen::Vector3f& d : about_z) {
    const Eigen::Vector3f direction = place.direction(d);
    if (is_blocked(model, place.point, direction, kReachM)) continue;
    ++open;
    towards += direction;
  }
  const auto count = static_cast<float>(about_z.size());
  return {static_cast<float>(open) / count, towards / count, Eigen::Vector3f::Zero()};
}

// The light that the hit surface reflects, as that of a light paint: a share of the irradiance
// about the direction in which the surface itself is open. Multiple reflections between surfaces
// that are equally open are included: of the light that leaves the surface, the hidden share
// returns.
Eigen::Vector3f given_back_by(const Model::Impl& model,
                              const ModelOpenness& openness,
                              const Hit& hit,
                              const Eigen::Vector3f& direction) {
  const auto part = static_cast<std::size_t>(hit.part);
  const TriangleOpenness& both = openness[part][hit.triangle];
  const bool is_back =
      face_of(model.mesh, model.mesh.parts[part].triangles[hit.triangle]).dot(direction) > 0;
  const Openness there = (is_back ? both.back : both.front).at(hit.u, hit.v);
  const float length = there.towards.norm();
  if (!(length > 1e-6f)) return Eigen::Vector3f::Zero();
  const float back = kOwnPaint * there.share / (1 - kOwnPaint * (1 - there.share));
  return back / length * there.towards;
}

// Calls visit(point, face, front, back) near each corner of all triangles of the parts that do not
// spin.
template <typename Visit>
void each_corner(const Model::Impl& model, ModelOpenness& openness, const Visit& visit) {
  for (std::size_t p = 0; p < model.mesh.parts.size(); ++p) {
    const aircraft::Part& part = model.mesh.parts[p];
    if (part.moves()) continue;
    tbb::parallel_for(std::size_t{0}, part.triangles.size(), [&](std::size_t i) {
      const Eigen::Vector3f face = face_of(model.mesh, part.triangles[i]);
      if (!face.allFinite()) return;
      std::array<Eigen::Vector3f, 3> corners;
      for (std::size_t k = 0; k < 3; ++k)
        corners[k] = model.mesh.positions[part.triangles[i].vertex[k]];
      const Eigen::Vector3f middle = (corners[0] + corners[1] + corners[2]) / 3;
      for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Vector3f point = corners[k] + kInset * (middle - corners[k]);
        visit(point, face, openness[p][i].front.corner[k], openness[p][i].back.corner[k]);
      }
    });
  }
}

// Adds the reflected light, from the known openness.
void find_given_back(const Model::Impl& model,
                     const ModelOpenness& known,
                     const Place& place,
                     std::span<const Eigen::Vector3f> about_z,
                     Openness& openness) {
  if (openness.share > kNothingHidden || openness.share == 0) return;
  for (const Eigen::Vector3f& d : about_z) {
    const Eigen::Vector3f direction = place.direction(d);
    if (const auto hit = nearest_blocker(model, place.point, direction, kReachM))
      openness.given_back += given_back_by(model, known, *hit, direction);
  }
  openness.given_back /= static_cast<float>(about_z.size());
}

}  // namespace

ModelOpenness model_openness(const Model::Impl& model) {
  std::size_t corners = 1;
  ModelOpenness result;
  for (const aircraft::Part& part : model.mesh.parts) {
    corners += 3 * part.triangles.size();
    result.emplace_back(part.triangles.size());
  }
  const std::size_t count = std::clamp(kMaxRays / corners, kMinDirections, kMaxDirections);
  const std::vector<Eigen::Vector3f> about_z = directions(count);
  const std::vector<Eigen::Vector3f> few_about_z =
      directions(std::max(kMinDirections, count / kFewer));
  each_corner(model, result, [&](const auto& point, const auto& face, auto& front, auto& back) {
    front = openness_at(model, Place(point, face), about_z);
    // Triangles may be turned inside out.
    const bool is_inside = front.share < kInside;
    back = openness_at(model, Place(point, -face), is_inside ? about_z : few_about_z);
  });
  const ModelOpenness known = result;
  each_corner(model, result, [&](const auto& point, const auto& face, auto& front, auto& back) {
    find_given_back(model, known, Place(point, face), few_about_z, front);
    find_given_back(model, known, Place(point, -face), few_about_z, back);
  });
  return result;
}

}  // namespace airtruth::render
