// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "picture/render/shade.h"

// Rays through an aircraft (Embree). Rays that start and point alike are traced in packets of
// eight, which is cheaper than one by one (Wald et al. 2001, "Interactive rendering with coherent
// ray tracing").
namespace airtruth::render {

// 1 for each ray that is_blocked() (model.h), else 0.
void find_blocked(const Model::Impl& model,
                  std::span<const BodyRay> rays,
                  std::span<std::uint8_t> blocked);

// The nearest surface along a ray from from_m on, at a time; empty where there is none.
// body_from_part: by part at that time.
std::optional<Hit> nearest_hit(const Model::Impl& model,
                               std::span<const Eigen::Affine3f> body_from_part,
                               const BodyRay& ray,
                               float from_m);

}  // namespace airtruth::render
