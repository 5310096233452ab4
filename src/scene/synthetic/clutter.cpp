// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/clutter.h"

#include <algorithm>
#include <cmath>

namespace airtruth::synthetic {
namespace {

// A triangle wave between 0 and 1.
float bounce(double x) {
  const double turn = x - 2 * std::floor(x / 2);
  return static_cast<float>(turn < 1 ? turn : 2 - turn);
}

}  // namespace

Clutter::Clutter(int width, int height, double share, std::uint32_t seed)
    : width_(width), height_(height), seed_(seed) {
  if (share <= 0) return;
  radius_ = 0.032F * static_cast<float>(height);
  const double disc = 3.14159 * radius_ * radius_;
  count_ = std::max(1, static_cast<int>(std::lround(share * width * height / disc)));
}

std::vector<Clutter::Disc> Clutter::at(double time_s) const {
  std::vector<Disc> discs;
  discs.reserve(static_cast<std::size_t>(count_));
  for (int i = 0; i < count_; ++i) {
    const std::uint32_t id = hash(i, 0, seed_);
    const auto draw = [&](std::uint32_t k) { return unit(mix(id + k)); };
    // One crossing of the image takes 8 to 40 s.
    const double across = time_s * (0.025 + 0.1 * draw(1)) + 2 * draw(2);
    const double along = time_s * (0.025 + 0.1 * draw(3)) + 2 * draw(4);
    discs.push_back({bounce(across) * static_cast<float>(width_),
                     bounce(along) * static_cast<float>(height_),
                     radius_ * (0.7F + 0.6F * draw(5)),
                     id});
  }
  return discs;
}

void Clutter::draw(const std::vector<Disc>& discs, int y, int width, LightRow& row) {
  for (const Disc& disc : discs) {
    const float dy = static_cast<float>(y) + 0.5F - disc.y;
    if (std::abs(dy) >= disc.radius) continue;
    const float reach = std::sqrt(disc.radius * disc.radius - dy * dy);
    const int first = std::max(static_cast<int>(disc.x - reach), 0);
    const int last = std::min(static_cast<int>(disc.x + reach) + 1, width);
    for (int x = first; x < last; ++x) {
      const float dx = static_cast<float>(x) + 0.5F - disc.x;
      const float edge = 1 - std::sqrt(dx * dx + dy * dy) / disc.radius;
      if (edge <= 0) continue;
      const float scale = 4.5F / disc.radius;
      const float mottle = fractal(dx * scale + 64, dy * scale + 64, 2, 128, disc.seed);
      const LinearRgb tone = linear_rgb(0.75F, 0.72F, 0.66F) * (mottle * mottle * 1.5F);
      const float covered = smoothstep(0.0F, 0.25F, edge);
      const auto i = static_cast<std::size_t>(x);
      row.red[i] += (tone[0] - row.red[i]) * covered;
      row.green[i] += (tone[1] - row.green[i]) * covered;
      row.blue[i] += (tone[2] - row.blue[i]) * covered;
    }
  }
}

}  // namespace airtruth::synthetic
