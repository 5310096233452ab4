// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <vector>

#include "picture/render/tracer.h"

namespace airtruth::render {

// The sums of a patch during its refinement.
struct Canvas {
  Canvas(const PixelBox& where, std::size_t actor_count)
      : patch(where),
        actors(actor_count),
        sums(static_cast<std::size_t>(where.width) * static_cast<std::size_t>(where.height)),
        coverage(sums.size() * actor_count),
        alone(sums.size() * actor_count) {}

  PixelBox patch;
  std::size_t actors;
  std::vector<Sum> sums;
  // Index: pixel * actors + actor.
  std::vector<double> coverage;
  std::vector<double> alone;

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - patch.y) * static_cast<std::size_t>(patch.width) +
           static_cast<std::size_t>(x - patch.x);
  }
};

// Fills a canvas: first every pixel that an aircraft may touch, with few samples, then those on an
// outline, with many.
void fill(const View& view,
          const std::vector<TracedIntruder>& actors,
          const Tracer& tracer,
          const RayGrid& grid,
          const SampleCounts& counts,
          const std::stop_token& stop,
          Canvas& canvas);

}  // namespace airtruth::render
