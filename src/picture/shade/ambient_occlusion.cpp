// SPDX-License-Identifier: Apache-2.0
#include "picture/shade/ambient_occlusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>

#include <tbb/parallel_for.h>

#include "foundation/base/error.h"
#include "picture/shade/trace.h"

namespace airtruth::shade {
namespace {

// Where a constant of this file states no origin, it is a choice; docs/decisions/0019 compares the
// result with a path tracer.

// Rays for a whole model, which take under a second on two cores.
constexpr std::size_t kMaxRays = 1'500'000;
// Directions for each corner: one step is 1/64 of all light.
constexpr std::size_t kMaxDirections = 64;
constexpr std::size_t kMinDirections = 8;
// Ratio of that number to the number of directions for insides and for reflected light.
constexpr std::size_t kFewer = 4;
// A side with a smaller open share is probably the inside of a hull.
constexpr float kInside = 0.1f;
// Distance from a corner towards the triangle's middle, as a share.
constexpr float kInset = 0.25f;
// Start of a ray above the surface: model files draw markings a centimetre above hulls.
constexpr float kStartM = 0.02f;
// Albedo, a ratio, of the hiding parts: a light paint.
constexpr float kOwnPaint = 0.6f;
// Length of a ray, which exceeds half the length of any aircraft.
constexpr float kRayM = 60.0f;

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

// A point slightly above a side of a triangle.
struct Place {
  Eigen::Vector3f point;
  Eigen::Vector3f normal;
  std::array<Eigen::Vector3f, 2> across;

  Place(const Eigen::Vector3f& on_surface, const Eigen::Vector3f& unit_normal)
      : point(on_surface + kStartM * unit_normal),
        normal(unit_normal),
        across(axes_across(unit_normal)) {}
  BodyRay ray(const Eigen::Vector3f& about_z) const {
    return {point, about_z.x() * across[0] + about_z.y() * across[1] + about_z.z() * normal};
  }
};

AmbientOcclusion occlusion_at(const Model::Impl& model,
                              const Place& place,
                              std::span<const Eigen::Vector3f> about_z) {
  std::size_t open = 0;
  Eigen::Vector3f towards(0, 0, 0);
  for (const Eigen::Vector3f& d : about_z) {
    const BodyRay ray = place.ray(d);
    if (is_blocked(model, ray, kRayM)) continue;
    ++open;
    towards += ray.direction;
  }
  const auto count = static_cast<float>(about_z.size());
  return {static_cast<float>(open) / count, towards / count, Eigen::Vector3f::Zero()};
}

// The light that the hit surface reflects, as that of a light paint: a share of the irradiance
// about the direction in which the surface itself is open. Multiple reflections between surfaces
// that are equally open are included: of the light that leaves the surface, the hidden share
// returns.
Eigen::Vector3f given_back_by(const Model::Impl& model,
                              const ModelOcclusion& occlusion,
                              const Hit& hit,
                              const Eigen::Vector3f& direction) {
  const auto part = static_cast<std::size_t>(hit.part);
  const TriangleOcclusion& both = occlusion[part][hit.triangle];
  const bool is_back = model.facets[part][hit.triangle].face.dot(direction) > 0;
  const AmbientOcclusion there = (is_back ? both.back : both.front).at(hit.u, hit.v);
  const float length = there.towards.norm();
  if (!(length > 1e-6f)) return Eigen::Vector3f::Zero();
  const float back = kOwnPaint * there.open_share / (1 - kOwnPaint * (1 - there.open_share));
  return back / length * there.towards;
}

// Calls visit(point, face, front, back) near each corner of all triangles of the parts that do not
// spin.
template <typename Visit>
void each_corner(const Model::Impl& model, ModelOcclusion& occlusion, const Visit& visit) {
  for (std::size_t p = 0; p < model.mesh.parts.size(); ++p) {
    const model::Part& part = model.mesh.parts[p];
    if (part.moves()) continue;
    tbb::parallel_for(std::size_t{0}, part.triangles.size(), [&](std::size_t i) {
      const Facet& of = model.facets[p][i];
      if (!(of.face.squaredNorm() > 0)) return;
      const Eigen::Vector3f middle = (of.corner[0] + of.corner[1] + of.corner[2]) / 3;
      for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Vector3f point = of.corner[k] + kInset * (middle - of.corner[k]);
        visit(point, of.face, occlusion[p][i].front.corner[k], occlusion[p][i].back.corner[k]);
      }
    });
  }
}

// Adds the reflected light, from the known ambient occlusion.
void find_given_back(const Model::Impl& model,
                     const ModelOcclusion& known,
                     const Place& place,
                     std::span<const Eigen::Vector3f> about_z,
                     AmbientOcclusion& occlusion) {
  if (occlusion.is_open() || occlusion.open_share == 0) return;
  for (const Eigen::Vector3f& d : about_z) {
    const BodyRay ray = place.ray(d);
    if (const auto hit = nearest_blocker(model, ray, kRayM))
      occlusion.given_back += given_back_by(model, known, *hit, ray.direction);
  }
  occlusion.given_back /= static_cast<float>(about_z.size());
}

// An entry has for each corner its open share, `towards` and `given_back`.
using StoredCorner = std::array<float, 7>;

template <typename Occlusion, typename Use>
void each_stored(Occlusion& occlusion, const Use& use) {
  for (auto& of_part : occlusion)
    for (auto& triangle : of_part)
      for (auto* side : {&triangle.front, &triangle.back})
        for (auto& corner : side->corner) use(corner);
}

bool is_sound(const AmbientOcclusion& occlusion) {
  // Largest deviation of a stored length from its bound by rounding.
  constexpr float kRounding = 1e-3f;
  const auto within = [](const Eigen::Vector3f& v) { return v.norm() <= 1 + kRounding; };
  return occlusion.open_share >= 0 && occlusion.open_share <= 1 && within(occlusion.towards) &&
         within(occlusion.given_back);
}

}  // namespace

ModelOcclusion model_occlusion(const Model::Impl& model) {
  std::size_t corners = 1;
  ModelOcclusion result;
  for (const model::Part& part : model.mesh.parts) {
    corners += 3 * part.triangles.size();
    result.emplace_back(part.triangles.size());
  }
  const std::size_t count = std::clamp(kMaxRays / corners, kMinDirections, kMaxDirections);
  const std::vector<Eigen::Vector3f> about_z = directions(count);
  const std::vector<Eigen::Vector3f> few_about_z =
      directions(std::max(kMinDirections, count / kFewer));
  each_corner(model, result, [&](const auto& point, const auto& face, auto& front, auto& back) {
    front = occlusion_at(model, Place(point, face), about_z);
    // Triangles may be turned inside out.
    const bool is_inside = front.open_share < kInside;
    back = occlusion_at(model, Place(point, -face), is_inside ? about_z : few_about_z);
  });
  const ModelOcclusion known = result;
  each_corner(model, result, [&](const auto& point, const auto& face, auto& front, auto& back) {
    find_given_back(model, known, Place(point, face), few_about_z, front);
    find_given_back(model, known, Place(point, -face), few_about_z, back);
  });
  return result;
}

disk_cache::Key occlusion_key(const model::Mesh& mesh, std::string_view tracer) {
  disk_cache::Key key("ambient occlusion");
  key.add(tracer).add(mesh.positions.size());
  for (const Eigen::Vector3f& p : mesh.positions) key.add(p.x()).add(p.y()).add(p.z());
  for (const model::Part& part : mesh.parts) {
    key.add(part.triangles.size()).add(part.moves());
    for (const model::Triangle& triangle : part.triangles)
      for (const std::uint32_t v : triangle.vertex) key.add(v);
  }
  return key;
}

std::string stored(const ModelOcclusion& occlusion) {
  std::string body;
  each_stored(occlusion, [&](const AmbientOcclusion& corner) {
    StoredCorner values{corner.open_share};
    std::copy_n(corner.towards.data(), 3, values.begin() + 1);
    std::copy_n(corner.given_back.data(), 3, values.begin() + 4);
    body.append(reinterpret_cast<const char*>(values.data()), sizeof(values));
  });
  return body;
}

ModelOcclusion occlusion_from(const std::string& body, const model::Mesh& mesh) {
  if (body.size() != 6 * mesh.triangle_count() * sizeof(StoredCorner))
    throw Error("ambient occlusion of another mesh");
  ModelOcclusion occlusion;
  for (const model::Part& part : mesh.parts) occlusion.emplace_back(part.triangles.size());
  const char* from = body.data();
  each_stored(occlusion, [&](AmbientOcclusion& corner) {
    StoredCorner v;
    std::memcpy(v.data(), from, sizeof(v));
    from += sizeof(v);
    corner = {v[0], {v[1], v[2], v[3]}, {v[4], v[5], v[6]}};
    if (!is_sound(corner)) throw Error("ambient occlusion out of range");
  });
  return occlusion;
}

}  // namespace airtruth::shade
