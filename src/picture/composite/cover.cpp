// SPDX-License-Identifier: Apache-2.0
#include "picture/composite/cover.h"

#include <algorithm>
#include <cmath>

namespace airtruth::composite {
namespace {

bool any_alpha(const AlphaMask& mask) {
  return std::any_of(mask.alpha.begin(), mask.alpha.end(), [](std::uint8_t a) { return a > 0; });
}

}  // namespace

std::uint8_t alpha_code(float coverage) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(coverage, 0.0F, 1.0F)));
}

AlphaMask alpha_mask(const image::Layer& layer,
                     std::size_t intruder,
                     const image::Mask* own_aircraft) {
  AlphaMask mask;
  if (layer.is_masked) own_aircraft = nullptr;
  if (intruder >= layer.coverage.size() || layer.coverage[intruder].empty()) return mask;
  const std::vector<float>& coverage = layer.coverage[intruder];
  mask.patch = layer.patch;
  mask.alpha.assign(coverage.size(), 0);
  for (int y = layer.patch.y; y < layer.patch.bottom(); ++y)
    for (int x = layer.patch.x; x < layer.patch.right(); ++x) {
      const std::size_t i = layer.index(x, y);
      if (own_aircraft == nullptr || own_aircraft->is_free(x, y))
        mask.alpha[i] = alpha_code(coverage[i]);
    }
  if (!any_alpha(mask)) mask = {};
  return mask;
}

std::optional<Covered> covered(const AlphaMask& mask) {
  int left = mask.patch.width, right = -1, top = mask.patch.height, bottom = -1;
  std::size_t i = 0;
  std::int64_t area_px = 0;
  for (int y = 0; y < mask.patch.height; ++y)
    for (int x = 0; x < mask.patch.width; ++x, ++i) {
      if (mask.alpha[i] < kCoveredAlpha) continue;
      ++area_px;
      left = std::min(left, x);
      right = std::max(right, x);
      top = std::min(top, y);
      bottom = y;
    }
  if (right < 0) return std::nullopt;
  return Covered{{mask.patch.x + left, mask.patch.y + top, right - left + 1, bottom - top + 1},
                 area_px};
}

std::optional<Covered> covered(const image::Layer& layer,
                               std::size_t intruder,
                               const image::Mask* own_aircraft) {
  return covered(alpha_mask(layer, intruder, own_aircraft));
}

void find_free_area(image::Layer& layer, const image::Mask& own_aircraft) {
  for (std::size_t a = 0; a < layer.coverage.size(); ++a) {
    if (layer.coverage[a].empty()) continue;
    for (int y = layer.patch.y; y < layer.patch.bottom(); ++y)
      for (int x = layer.patch.x; x < layer.patch.right(); ++x)
        if (!own_aircraft.is_free(x, y))
          layer.area_free_px[a] -= static_cast<double>(layer.coverage[a][layer.index(x, y)]);
  }
}

}  // namespace airtruth::composite
