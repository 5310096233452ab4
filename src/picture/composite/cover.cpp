// SPDX-License-Identifier: Apache-2.0
#include "picture/composite/cover.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace airtruth::composite {
namespace {

std::vector<float> shares_past(const std::vector<const Occluder*>& before, const PixelBox& patch) {
  std::vector<float> shares;
  if (before.empty()) return shares;
  shares.reserve(pixels_in(patch));
  for (int y = patch.y; y < patch.bottom(); ++y)
    for (int x = patch.x; x < patch.right(); ++x) {
      float share = 1;
      for (const Occluder* occluder : before)
        if (share > 0) share *= 1 - occluder->cover(x, y);
      shares.push_back(share);
    }
  return shares;
}

// Marks the pixels in which no intruder of the layer shows.
void close(image::Layer& layer, Shares& shares) {
  layer.closed.assign(layer.pixels.size(), 1);
  std::set<const std::vector<float>*> known;
  for (std::size_t a = 0; a < layer.coverage.size(); ++a) {
    if (layer.coverage[a].empty()) continue;
    const std::vector<float>& shown = shares.past_all(a);
    if (!known.insert(&shown).second) continue;
    for (std::size_t i = 0; i < layer.closed.size(); ++i)
      if (share_of(shown, i) > 0) layer.closed[i] = 0;
  }
}

}  // namespace

std::uint8_t alpha_code(float coverage) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(coverage, 0.0F, 1.0F)));
}

AlphaMask alpha_mask(const image::Layer& layer, std::size_t intruder) {
  AlphaMask mask;
  if (intruder >= layer.coverage.size() || layer.coverage[intruder].empty()) return mask;
  mask.patch = layer.coverage[intruder].box;
  each_pixel(layer.coverage[intruder], [&](int x, int y, float share) {
    mask.alpha.push_back(layer.is_open(layer.index(x, y)) ? alpha_code(share) : 0);
  });
  if (std::ranges::max(mask.alpha) == 0) mask = {};
  return mask;
}

std::optional<Covered> covered(const AlphaMask& mask) { return covered(mask, mask.patch); }

std::optional<Covered> covered(const AlphaMask& mask, const PixelBox& part) {
  std::optional<Covered> covered;
  const auto both = mask.empty() ? std::nullopt : intersection(mask.patch, part);
  if (!both) return covered;
  for (int y = both->y; y < both->bottom(); ++y)
    for (int x = both->x; x < both->right(); ++x) {
      if (mask.alpha[index_in(mask.patch, x, y)] < kCoveredAlpha) continue;
      if (!covered) covered = Covered{{x, y, 1, 1}};
      covered->box = bounds(covered->box, {x, y, 1, 1});
      ++covered->area_px;
    }
  return covered;
}

std::optional<Covered> covered(const image::Layer& layer, std::size_t intruder) {
  return covered(alpha_mask(layer, intruder));
}

Occluder own_aircraft(const image::Mask& mask) {
  return {0, [&mask](int x, int y) { return mask.is_free(x, y) ? 0.0F : 1.0F; }};
}

const std::vector<float>& Shares::past(double range_m) {
  std::vector<const Occluder*> before;
  for (const Occluder& occluder : occlusion_.occluders)
    if (occluder.range_m < range_m) before.push_back(&occluder);
  const auto [at, is_new] = known_.try_emplace(before.size());
  if (is_new) at->second = shares_past(before, patch_);
  return at->second;
}

const std::vector<float>& Shares::past_own_aircraft() {
  return past(std::numeric_limits<double>::min());
}

const std::vector<float>& Shares::past_all(std::size_t intruder) {
  return past(intruder < occlusion_.ranges_m.size() ? occlusion_.ranges_m[intruder] : 0);
}

void find_areas(image::Layer& layer, const Occlusion& occlusion) {
  if (occlusion.occluders.empty()) return;
  Shares shares(occlusion, layer.patch);
  const std::vector<float>& free = shares.past_own_aircraft();
  for (std::size_t a = 0; a < layer.coverage.size(); ++a) {
    const std::vector<float>& clear = shares.past_all(a);
    each_pixel(layer.coverage[a], [&](int x, int y, double share) {
      if (!(share > 0)) return;
      const std::size_t i = layer.index(x, y);
      layer.areas[a].free_px -= (1 - share_of(free, i)) * share;
      layer.areas[a].clear_px -= (1 - share_of(clear, i)) * share;
    });
  }
}

void hide(image::Layer& layer, const Occlusion& occlusion) {
  if (occlusion.occluders.empty() || layer.empty()) return;
  Shares shares(occlusion, layer.patch);
  close(layer, shares);
  std::vector<float> before(layer.pixels.size(), 0), after(layer.pixels.size(), 0);
  for (std::size_t a = 0; a < layer.coverage.size(); ++a) {
    const std::vector<float>& shown = shares.past_all(a);
    each_pixel(layer.coverage[a], [&](int x, int y, float& share) {
      const std::size_t i = layer.index(x, y);
      before[i] += share;
      if (layer.is_open(i)) share *= static_cast<float>(share_of(shown, i));
      after[i] += share;
    });
  }
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (after[i] == before[i]) continue;
    const float kept = after[i] / before[i];
    image::LayerPixel& pixel = layer.pixels[i];
    pixel = {kept * pixel.red, kept * pixel.green, kept * pixel.blue, kept * pixel.alpha};
    if (kept == 0) layer.depth_m[i] = std::numeric_limits<float>::infinity();
  }
}

}  // namespace airtruth::composite
