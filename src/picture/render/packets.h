// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "picture/render/shade.h"

// Queries of many rays at once. Embree traces rays that start and point alike in packets of eight,
// which is cheaper than one by one (Wald et al. 2001, "Interactive rendering with coherent ray
// tracing").
namespace airtruth::render {

// The nearest surface along each ray from its `from_m` on; empty where there is none. Each ray has
// its own time within the frame, for the parts that spin. The spans have one length.
void nearest_hits(const Placed& placed,
                  std::span<const BodyRay> rays,
                  std::span<const double> dt_s,
                  std::span<const float> from_m,
                  std::span<std::optional<Hit>> hits);
// The same from the rays' origins on.
void nearest_hits(const Placed& placed,
                  std::span<const BodyRay> rays,
                  std::span<const double> dt_s,
                  std::span<std::optional<Hit>> hits);

// 1 for each ray that is_blocked() (model.h), else 0.
void find_blocked(const Model::Impl& model,
                  std::span<const BodyRay> rays,
                  std::span<std::uint8_t> blocked);

// A part's coordinates from the body's. The pose of a spinning part differs at every moment of the
// exposure.
Eigen::Affine3f part_from_body(const Placed& placed, std::size_t part, double dt_s);

}  // namespace airtruth::render
