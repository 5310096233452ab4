// SPDX-License-Identifier: Apache-2.0
#include "foundation/image/contrast_to_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "foundation/base/median.h"

namespace airtruth::image {
namespace {

constexpr double kBeyond = 3;  // standard deviations: of normal noise, 0.3 % lie beyond
const double kRounding = 1 / std::sqrt(12.0);  // grey levels: the deviation of a uniform error

double deviation_about(const std::vector<std::uint8_t>& values, double centre, double reach) {
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

}  // namespace

std::optional<double> contrast_to_noise(const Picture& picture, const PixelBox& box) {
  const PixelBox whole{0, 0, picture.width, picture.height};
  const int ring = std::max(kLeastRing_px, std::min(box.width, box.height));
  const PixelBox gap = wider(box, 1);
  const auto around = intersection(wider(gap, ring), whole);
  const auto inside = intersection(box, whole);
  if (!around || !inside) return std::nullopt;
  std::vector<std::uint8_t> outside;
  for (int y = around->y; y < around->bottom(); ++y)
    for (int x = around->x; x < around->right(); ++x)
      if (!gap.contains(x, y)) outside.push_back(picture.luma().row(y)[x]);
  if (outside.size() < kLeastRingPixels) return std::nullopt;
  const double background = median(outside);
  const double all = std::max(kRounding, deviation_about(outside, background, 256));
  const double noise = std::max(kRounding, deviation_about(outside, background, kBeyond * all));
  double sum = 0;
  for (int y = inside->y; y < inside->bottom(); ++y)
    for (int x = inside->x; x < inside->right(); ++x) {
      const double off = picture.luma().row(y)[x] - background;
      sum += off * off;
    }
  return std::sqrt(sum / (double(inside->width) * inside->height)) / noise;
}

}  // namespace airtruth::image
