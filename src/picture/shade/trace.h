// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "picture/shade/shade.h"

// Rays through an aircraft (Embree). Rays that start and point alike are traced in packets of
// eight, which is cheaper than one by one (Wald et al. 2001, "Interactive rendering with coherent
// ray tracing").
namespace airtruth::shade {

// True where a part of the aircraft blocks the ray within `within_m`. Spinning parts do not block:
// most of a propeller's disc is air.
bool is_blocked(const Model::Impl& model, const BodyRay& ray, float within_m = INFINITY);

// The nearest hit that is_blocked() counts, by its distance from the origin; empty where nothing
// blocks the ray.
std::optional<Hit> nearest_blocker(const Model::Impl& model, const BodyRay& ray, float within_m);

// 1 for each ray that is_blocked(), else 0.
void find_blocked(const Model::Impl& model,
                  std::span<const BodyRay> rays,
                  std::span<std::uint8_t> blocked);

// The nearest surface along a ray from from_m on, at a time; empty where there is none.
// body_from_part: by part at that time.
std::optional<Hit> nearest_hit(const Model::Impl& model,
                               std::span<const Eigen::Affine3f> body_from_part,
                               const BodyRay& ray,
                               float from_m);

}  // namespace airtruth::shade
