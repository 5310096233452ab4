// SPDX-License-Identifier: Apache-2.0
#include "picture/shade/trace.h"

#include <algorithm>
#include <array>

namespace airtruth::shade {
namespace {

// Number of rays in a packet of Embree (RTCRay8).
constexpr std::size_t kLanes = 8;

using Lanes = std::array<int, kLanes>;  // -1 for a lane with a ray, else 0

void find_blocked_of_eight(const Model::Impl& model,
                           std::span<const BodyRay> rays,
                           std::span<std::uint8_t> blocked) {
  alignas(32) RTCRay8 packet{};
  alignas(32) Lanes valid;
  for (std::size_t i = 0; i < kLanes; ++i) {
    valid[i] = i < rays.size() ? -1 : 0;
    const BodyRay& ray = rays[std::min(i, rays.size() - 1)];
    packet.org_x[i] = ray.origin.x();
    packet.org_y[i] = ray.origin.y();
    packet.org_z[i] = ray.origin.z();
    packet.dir_x[i] = ray.direction.x();
    packet.dir_y[i] = ray.direction.y();
    packet.dir_z[i] = ray.direction.z();
    packet.tfar[i] = INFINITY;
    packet.mask[i] = 0xffffffffU;
  }
  for (std::size_t part = 0; part < model.scenes.size(); ++part) {
    if (model.mesh.parts[part].moves()) continue;
    occlude(valid.data(), model.scenes[part].get(), packet);
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (packet.tfar[i] < 0) valid[i] = 0;
  }
  for (std::size_t i = 0; i < rays.size(); ++i) blocked[i] = packet.tfar[i] < 0 ? 1 : 0;
}

RTCRay ray_between(const BodyRay& of, float from_m, float to_m) {
  RTCRay ray{};
  ray.org_x = of.origin.x(), ray.org_y = of.origin.y(), ray.org_z = of.origin.z();
  ray.dir_x = of.direction.x(), ray.dir_y = of.direction.y(), ray.dir_z = of.direction.z();
  ray.tnear = from_m;
  ray.tfar = to_m;
  ray.mask = 0xffffffffU;
  return ray;
}

}  // namespace

bool is_blocked(const Model::Impl& model, const BodyRay& body_ray, float within_m) {
  for (std::size_t i = 0; i < model.scenes.size(); ++i) {
    if (model.mesh.parts[i].moves()) continue;
    RTCRay ray = ray_between(body_ray, 0, within_m);
    occlude(model.scenes[i].get(), ray);
    if (ray.tfar < 0) return true;
  }
  return false;
}

std::optional<Hit> nearest_blocker(const Model::Impl& model, const BodyRay& ray, float within_m) {
  // Embree shortens the ray to the distance of the nearest hit so far.
  RTCRayHit query{ray_between(ray, 0, within_m), {}};
  std::optional<Hit> best;
  for (std::size_t i = 0; i < model.scenes.size(); ++i) {
    if (model.mesh.parts[i].moves()) continue;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    intersect(model.scenes[i].get(), query);
    if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID)
      best = Hit{query.ray.tfar, static_cast<int>(i), query.hit.primID, query.hit.u, query.hit.v};
  }
  return best;
}

void find_blocked(const Model::Impl& model,
                  std::span<const BodyRay> rays,
                  std::span<std::uint8_t> blocked) {
  for (std::size_t i = 0; i < rays.size(); i += kLanes) {
    const std::size_t n = std::min(kLanes, rays.size() - i);
    find_blocked_of_eight(model, rays.subspan(i, n), blocked.subspan(i, n));
  }
}

std::optional<Hit> nearest_hit(const Model::Impl& model,
                               std::span<const Eigen::Affine3f> body_from_part,
                               const BodyRay& ray,
                               float from_m) {
  std::optional<Hit> best;
  float far_m = INFINITY;
  for (std::size_t part = 0; part < model.scenes.size(); ++part) {
    const bool turns = model.mesh.parts[part].moves();
    const Eigen::Affine3f part_from_body =
        turns ? body_from_part[part].inverse(Eigen::Isometry) : Eigen::Affine3f::Identity();
    const BodyRay in_part{part_from_body * ray.origin, part_from_body.linear() * ray.direction};
    RTCRayHit query{ray_between(in_part, from_m, far_m), {}};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    intersect(model.scenes[part].get(), query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
    far_m = query.ray.tfar;
    best = Hit{far_m, static_cast<int>(part), query.hit.primID, query.hit.u, query.hit.v};
  }
  return best;
}

}  // namespace airtruth::shade
