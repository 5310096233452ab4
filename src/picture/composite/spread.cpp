// SPDX-License-Identifier: Apache-2.0
#include "picture/composite/spread.h"

#include <algorithm>
#include <cmath>

#include "foundation/base/error.h"
#include "foundation/base/vectors.h"

namespace airtruth::composite {
namespace {

// Reach of the kernel, in standard deviations; 0.3 % of a Gaussian lie beyond it.
constexpr double kReach = 3;
// Coverage, as a share, below which no sample of 8 bits changes: 1/16 of a code value.
constexpr float kNothing = 1.0F / 4096;

int reach_of(double sigma_px) { return static_cast<int>(std::ceil(kReach * sigma_px)); }

// A loop that the compiler makes of vectors; each sum of a blur has one order, that of the kernel.
AIRTRUTH_FOR_VECTORS void add_scaled(const float* __restrict from,
                                     float weight,
                                     int count,
                                     float* __restrict to) {
  for (int i = 0; i < count; ++i) to[i] += weight * from[i];
}

}  // namespace

void add_haze(image::Layer& layer,
              const std::array<double, 3>& extinction_per_km,
              const std::array<double, 3>& airlight) {
  for (std::size_t i = 0; i < layer.pixels.size(); ++i) {
    image::LayerPixel& pixel = layer.pixels[i];
    if (!(pixel.alpha > 0)) continue;
    const double range_km = static_cast<double>(layer.depth_m[i]) / 1000;
    float* const rgb[3] = {&pixel.red, &pixel.green, &pixel.blue};
    for (std::size_t c = 0; c < 3; ++c) {
      const auto through = static_cast<float>(std::exp(-extinction_per_km[c] * range_km));
      *rgb[c] = *rgb[c] * through + pixel.alpha * static_cast<float>(airlight[c]) * (1 - through);
    }
  }
}

std::vector<float> gaussian(double sigma_px) {
  if (!(sigma_px > 0)) return {1};
  const int reach = std::max(1, reach_of(sigma_px));
  std::vector<float> kernel;
  double total = 0;
  const auto below = [&](double x) { return 0.5 * std::erf(x / (sigma_px * std::sqrt(2.0))); };
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(static_cast<float>(below(i + 0.5) - below(i - 0.5)));
    total += static_cast<double>(kernel.back());
  }
  for (float& weight : kernel) weight = static_cast<float>(weight / total);
  return kernel;
}

void blur(std::vector<float>& values,
          int width,
          int height,
          const std::vector<float>& across,
          const std::vector<float>& down) {
  check(values.size() == pixels_in(width, height), "a plane of the size that it says");
  const auto row_of = [&](std::vector<float>& plane, int y) {
    return plane.data() + index_in(width, 0, y);
  };
  const int reach_x = static_cast<int>(across.size()) / 2;
  if (reach_x > 0) {
    std::vector<float> line(static_cast<std::size_t>(width + 2 * reach_x), 0.0F);
    for (int y = 0; y < height; ++y) {
      float* const row = row_of(values, y);
      std::copy_n(row, width, line.data() + reach_x);
      std::fill_n(row, width, 0.0F);
      for (std::size_t k = 0; k < across.size(); ++k)
        add_scaled(line.data() + k, across[k], width, row);
    }
  }
  const int reach_y = static_cast<int>(down.size()) / 2;
  if (reach_y == 0) return;
  std::vector<float> from(values.size(), 0.0F);
  std::swap(from, values);
  for (int y = 0; y < height; ++y)
    for (int k = 0; k < static_cast<int>(down.size()); ++k)
      if (const int source = y + k - reach_y; source >= 0 && source < height)
        add_scaled(
            row_of(from, source), down[static_cast<std::size_t>(k)], width, row_of(values, y));
}

std::vector<float> blurred(const std::vector<float>& values,
                           const PixelBox& from,
                           const PixelBox& to,
                           const PixelBox& frame,
                           const std::vector<float>& across,
                           const std::vector<float>& down) {
  const int reach_x = static_cast<int>(across.size()) / 2;
  const int reach_y = static_cast<int>(down.size()) / 2;
  const int left = to.x == frame.x ? reach_x : 0;
  const int top = to.y == frame.y ? reach_y : 0;
  const PixelBox around{to.x - left,
                        to.y - top,
                        to.width + left + (to.right() == frame.right() ? reach_x : 0),
                        to.height + top + (to.bottom() == frame.bottom() ? reach_y : 0)};
  std::vector<float> plane(pixels_in(around), 0.0F);
  for (int y = around.y; y < around.bottom(); ++y)
    for (int x = around.x; x < around.right(); ++x) {
      const int at_x = std::clamp(x, frame.x, frame.right() - 1);
      const int at_y = std::clamp(y, frame.y, frame.bottom() - 1);
      if (from.contains(at_x, at_y))
        plane[index_in(around, x, y)] = values[index_in(from, at_x, at_y)];
    }
  blur(plane, around.width, around.height, across, down);
  if (around == to) return plane;
  std::vector<float> result;
  result.reserve(pixels_in(to));
  for (int y = to.y; y < to.bottom(); ++y) {
    const auto row = plane.begin() + static_cast<std::ptrdiff_t>(index_in(around, to.x, y));
    result.insert(result.end(), row, row + to.width);
  }
  return result;
}

image::Layer spread(const image::Layer& layer,
                    const PointSpread& point_spread,
                    int margin_px,
                    int frame_width,
                    int frame_height) {
  if (layer.empty()) return layer;
  const std::vector<float> across = gaussian(point_spread.across_px);
  const std::vector<float> down = gaussian(point_spread.down_px);
  const int reach = static_cast<int>(std::max(across.size(), down.size()) / 2);
  const int more = reach + margin_px;
  if (more == 0) return layer;
  const PixelBox frame{0, 0, frame_width, frame_height};
  image::Layer result(*intersection(wider(layer.patch, more), frame));
  result.areas = layer.areas;
  const auto of_layer = [&](const auto& get) {
    std::vector<float> values(layer.pixels.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = get(i);
    return blurred(values, layer.patch, result.patch, frame, across, down);
  };
  const auto alpha = of_layer([&](std::size_t i) { return layer.pixels[i].alpha; });
  const auto red = of_layer([&](std::size_t i) { return layer.pixels[i].red; });
  const auto green = of_layer([&](std::size_t i) { return layer.pixels[i].green; });
  const auto blue = of_layer([&](std::size_t i) { return layer.pixels[i].blue; });
  const auto depth = of_layer([&](std::size_t i) {
    return layer.pixels[i].alpha > 0 ? layer.pixels[i].alpha * layer.depth_m[i] : 0.0F;
  });
  for (std::size_t i = 0; i < result.pixels.size(); ++i) {
    if (alpha[i] < kNothing) continue;
    result.pixels[i] = {red[i], green[i], blue[i], std::min(1.0F, alpha[i])};
    result.depth_m[i] = depth[i] / alpha[i];
  }
  for (const image::Coverage& coverage : layer.coverage) {
    image::Coverage& spread = result.coverage.emplace_back();
    if (coverage.empty()) continue;
    spread.box = *intersection(wider(coverage.box, reach), result.patch);
    spread.alpha = blurred(coverage.alpha, coverage.box, spread.box, frame, across, down);
    each_pixel(spread, [&](int x, int y, float& share) {
      if (!(result.pixels[result.index(x, y)].alpha > 0)) share = 0;
    });
  }
  return result;
}

}  // namespace airtruth::composite
