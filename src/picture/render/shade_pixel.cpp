// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "picture/render/packets.h"
#include "picture/render/pixel_light.h"
#include "picture/render/pixel_rays.h"
#include "picture/render/tracer.h"

// The light of a pixel that one opaque actor covers (Tracer).
namespace airtruth::render {
namespace {

// Finds the surfaces that rays meet. A sample that meets none is left out: so close to an edge the
// float and the double computation disagree.
void find_visible(const Placed& placed,
                  const PixelRays& rays_of,
                  const PixelSamples& order,
                  std::span<const int> samples,
                  Visible& visible) {
  const std::size_t n = samples.size();
  std::array<BodyRay, SampleCounts::kMostShaded> rays;
  std::array<double, SampleCounts::kMostShaded> dt_s;
  std::array<std::optional<Hit>, SampleCounts::kMostShaded> hits;
  for (std::size_t i = 0; i < n; ++i) rays[i] = rays_of.ray(samples[i], dt_s[i]);
  nearest_hits(
      placed, std::span(rays).first(n), std::span(dt_s).first(n), std::span(hits).first(n));
  // By part, triangle and sample. Few hits are out of order.
  std::array<std::array<std::uint64_t, 2>, SampleCounts::kMostShaded> keys;
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!hits[i]) continue;
    const std::uint64_t key = static_cast<std::uint64_t>(hits[i]->part) << 32 | hits[i]->triangle;
    std::size_t to = count++;
    for (; to > 0 && keys[to - 1][0] > key; --to) keys[to] = keys[to - 1];
    keys[to] = {key, i};
  }
  visible.spots.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = keys[k][1];
    visible.spots[k] = {*hits[i], static_cast<float>(order.time(samples[i]))};
  }
}

}  // namespace

void Tracer::shade_visible(int x, int y, int actor_index, const Visible& visible, Sum& sum) const {
  const TracedIntruder& actor = actors_[static_cast<std::size_t>(actor_index)];
  const auto corners = grid_.corners(x, y);
  const double pixel_rad = (corners[1] - corners[0]).norm();
  const PixelLight light =
      light_of(actor.placed, PixelEye(actor, grid_, x, y), visible, light_, pixel_rad);
  sum.opaque_rgb = light.rgb;
  sum.opaque_shaded = 1;
  sum.depth = light.distance_m * sum.alpha;
}

bool Tracer::shade_covered(int x, int y, int actor_index, const Cover& cover, Sum& sum) const {
  // About one code value of a video in the middle of its range.
  constexpr float kTolerance = 0.015f;
  const TracedIntruder& actor = actors_[static_cast<std::size_t>(actor_index)];
  const PixelRays rays(actor, grid_, x, y);
  const PixelEye eye(rays, actor.moves && grid_.exposure_s() > 0);
  const PixelSamples order(x, y);
  const int all = cover.samples();
  const auto share = static_cast<float>(sum.alpha / sum.count);
  thread_local Visible visible;
  visible.of_samples = counts_.shaded;
  Spread spread;
  double distance_sum_m = 0;
  for (int next = 0; spread.count < counts_.shaded && !spread.is_known(share, kTolerance);) {
    std::array<int, SampleCounts::kMostShaded> samples;
    std::size_t n = 0;
    const auto wanted =
        static_cast<std::size_t>(std::min(counts_.shaded_alike, counts_.shaded - spread.count));
    for (; next < all && n < wanted; ++next)
      if (cover.covers(order, next)) samples[n++] = next;
    if (n == 0) break;
    find_visible(actor.placed, rays, order, {samples.data(), n}, visible);
    if (visible.spots.empty()) continue;
    const PixelLight light = light_of(actor.placed, eye, visible, light_, rays.pixel_rad());
    distance_sum_m += light.distance_m * light.spread.count;
    spread.add(light.spread);
  }
  if (spread.count == 0) return false;
  for (std::size_t c = 0; c < 3; ++c) sum.opaque_rgb[c] = static_cast<double>(spread.sum[c]);
  sum.opaque_shaded = spread.count;
  sum.depth = distance_sum_m / spread.count * sum.alpha;
  return true;
}

}  // namespace airtruth::render
