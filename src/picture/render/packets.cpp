// SPDX-License-Identifier: Apache-2.0
#include "picture/render/packets.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace airtruth::render {
namespace {

constexpr std::size_t kLanes = 8;

using Lanes = std::array<int, kLanes>;  // -1 for a lane with a ray, else 0

void set_ray(RTCRay8& packet, std::size_t lane, const BodyRay& ray) {
  packet.org_x[lane] = ray.origin.x();
  packet.org_y[lane] = ray.origin.y();
  packet.org_z[lane] = ray.origin.z();
  packet.dir_x[lane] = ray.direction.x();
  packet.dir_y[lane] = ray.direction.y();
  packet.dir_z[lane] = ray.direction.z();
}

// The rays of up to eight lanes, from their origins to infinity.
void set_rays(RTCRay8& packet, Lanes& valid, std::span<const BodyRay> rays) {
  packet = {};
  for (std::size_t i = 0; i < kLanes; ++i) {
    valid[i] = i < rays.size() ? -1 : 0;
    set_ray(packet, i, rays[std::min(i, rays.size() - 1)]);
    packet.tfar[i] = INFINITY;
    packet.mask[i] = 0xffffffffU;
  }
}

void nearest_hits_of_eight(const Placed& placed,
                           std::span<const BodyRay> rays,
                           std::span<const double> dt_s,
                           std::span<const float> from_m,
                           std::span<std::optional<Hit>> hits) {
  alignas(32) RTCRayHit8 packet;
  alignas(32) Lanes valid;
  set_rays(packet.ray, valid, rays);
  std::copy(from_m.begin(), from_m.end(), packet.ray.tnear);
  for (std::size_t part = 0; part < placed.model->scenes.size(); ++part) {
    const bool spins = placed.model->mesh.parts[part].moves();
    for (std::size_t i = 0; spins && i < rays.size(); ++i) {
      const Eigen::Affine3f here = part_from_body(placed, part, dt_s[i]);
      set_ray(packet.ray, i, {here * rays[i].origin, here.linear() * rays[i].direction});
    }
    std::fill_n(packet.hit.geomID, kLanes, RTC_INVALID_GEOMETRY_ID);
    // Embree shortens a ray to its nearest hit so far.
    intersect(valid.data(), placed.model->scenes[part].get(), packet);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID)
        hits[i] = Hit{packet.ray.tfar[i],
                      static_cast<int>(part),
                      packet.hit.primID[i],
                      packet.hit.u[i],
                      packet.hit.v[i]};
      if (spins) set_ray(packet.ray, i, rays[i]);
    }
  }
}

void find_blocked_of_eight(const Model::Impl& model,
                           std::span<const BodyRay> rays,
                           std::span<std::uint8_t> blocked) {
  alignas(32) RTCRay8 packet;
  alignas(32) Lanes valid;
  set_rays(packet, valid, rays);
  for (std::size_t part = 0; part < model.scenes.size(); ++part) {
    if (model.mesh.parts[part].moves()) continue;
    occlude(valid.data(), model.scenes[part].get(), packet);
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (packet.tfar[i] < 0) valid[i] = 0;
  }
  for (std::size_t i = 0; i < rays.size(); ++i) blocked[i] = packet.tfar[i] < 0 ? 1 : 0;
}

}  // namespace

Eigen::Affine3f part_from_body(const Placed& placed, std::size_t part, double dt_s) {
  if (dt_s == 0) return placed.part_from_body[part];
  if (!placed.swings[part].empty()) return placed.swings[part].at(dt_s);
  return aircraft::body_from_part(placed.model->mesh.parts[part], placed.time_s + dt_s)
      .inverse(Eigen::Isometry);
}

void nearest_hits(const Placed& placed,
                  std::span<const BodyRay> rays,
                  std::span<const double> dt_s,
                  std::span<const float> from_m,
                  std::span<std::optional<Hit>> hits) {
  std::fill(hits.begin(), hits.end(), std::nullopt);
  for (std::size_t i = 0; i < rays.size(); i += kLanes) {
    const std::size_t n = std::min(kLanes, rays.size() - i);
    nearest_hits_of_eight(placed,
                          rays.subspan(i, n),
                          dt_s.subspan(i, n),
                          from_m.empty() ? from_m : from_m.subspan(i, n),
                          hits.subspan(i, n));
  }
}

void nearest_hits(const Placed& placed,
                  std::span<const BodyRay> rays,
                  std::span<const double> dt_s,
                  std::span<std::optional<Hit>> hits) {
  nearest_hits(placed, rays, dt_s, {}, hits);
}

void find_blocked(const Model::Impl& model,
                  std::span<const BodyRay> rays,
                  std::span<std::uint8_t> blocked) {
  for (std::size_t i = 0; i < rays.size(); i += kLanes) {
    const std::size_t n = std::min(kLanes, rays.size() - i);
    find_blocked_of_eight(model, rays.subspan(i, n), blocked.subspan(i, n));
  }
}

}  // namespace airtruth::render
