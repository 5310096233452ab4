// SPDX-License-Identifier: Apache-2.0
#include "foundation/image/contrast_to_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "foundation/base/median.h"
#include "foundation/image/colour.h"

namespace airtruth::image {
namespace {

constexpr double kBeyond = 3;  // standard deviations: of normal noise, 0.3 % lie beyond
const double kRounding = 1 / std::sqrt(12.0);  // grey levels: the deviation of a uniform error

// The root mean square difference, of values that differ by no more than `reach`.
double deviation_about(const std::vector<std::uint8_t>& values, double centre, double reach = 256) {
  double sum = 0;
  double count = 0;
  for (const std::uint8_t value : values) {
    const double off = value - centre;
    if (std::abs(off) > reach) continue;
    sum += off * off;
    count += 1;
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

// Of what lies in the picture, without what lies in the hole.
std::vector<std::uint8_t> luma_in(const Picture& picture,
                                  const PixelBox& area,
                                  const PixelBox& hole = {}) {
  std::vector<std::uint8_t> values;
  const auto seen = intersection(area, {0, 0, picture.width, picture.height});
  if (!seen) return values;
  for (int y = seen->y; y < seen->bottom(); ++y)
    for (int x = seen->x; x < seen->right(); ++x)
      if (!hole.contains(x, y)) values.push_back(luma_at(picture, x, y));
  return values;
}

int ring_px(const PixelBox& box) {
  return std::max(kLeastRing_px, std::min(box.width, box.height));
}

}  // namespace

std::optional<double> contrast_to_noise(const Picture& picture, const PixelBox& box) {
  const PixelBox gap = wider(box, 1);
  const std::vector<std::uint8_t> inside = luma_in(picture, box);
  const std::vector<std::uint8_t> outside = luma_in(picture, wider(gap, ring_px(box)), gap);
  if (inside.empty() || outside.size() < kLeastRingPixels) return std::nullopt;
  const double background = median(outside);
  const double all = std::max(kRounding, deviation_about(outside, background));
  const double noise = std::max(kRounding, deviation_about(outside, background, kBeyond * all));
  return deviation_about(inside, background) / noise;
}

double contrast(const Picture& picture, const PixelBox& box) {
  const std::vector<std::uint8_t> inside = luma_in(picture, box);
  const std::vector<std::uint8_t> outside = luma_in(picture, wider(box, ring_px(box)), box);
  if (inside.empty() || outside.empty()) return 0;
  return deviation_about(inside, median(outside));
}

}  // namespace airtruth::image
