// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/sensor.h"

#include <algorithm>
#include <cmath>

#include "foundation/base/seed.h"
#include "foundation/image/colour.h"

namespace airtruth::synthetic {
namespace {

constexpr int kCurve = 8192;
constexpr float kBrightest = 2.5F;

// Code values 0..255 by the square root of light, so that dark tones are resolved as finely as
// bright ones.
std::vector<float> tone_curve(bool linear) {
  std::vector<float> curve(kCurve + 1);
  for (int i = 0; i <= kCurve; ++i) {
    const float root = static_cast<float>(i) / kCurve;
    const float light = root * root * kBrightest;
    const float exposed =
        linear ? light : light * (1 + 0.10F * light) / (1 + 0.42F * light) * 1.18F;
    curve[static_cast<std::size_t>(i)] = 255 * image::srgb_from_linear(std::min(exposed, 1.0F));
  }
  return curve;
}

std::uint8_t code(float value) {
  return static_cast<std::uint8_t>(static_cast<int>(std::clamp(value + 0.5F, 0.0F, 255.0F)));
}

}  // namespace

Sensor::Sensor(const FlightOptions& options, std::uint32_t seed)
    : width_(options.width),
      height_(options.height),
      noise_(options.ideal_sensor ? 0 : static_cast<float>(options.noise)),
      ideal_(options.ideal_sensor),
      seed_(seed),
      curve_(tone_curve(options.linear_light)) {
  Random random(seed_);
  for (auto& tile : grain_) tile.resize(std::size_t{kGrain} * kGrain);
  for (std::size_t i = 0; i < grain_[0].size(); ++i)
    for (auto& tile : grain_) tile[i] = static_cast<float>(random.normal());
}

Sensor::Exposure Sensor::start() const {
  return Exposure(stride() * static_cast<std::size_t>(height_));
}

// Every 16 rows use another part of the noise tile, so that no pattern repeats.
Sensor::Grain Sensor::grain(int frame, int y, std::size_t channel) const {
  const std::uint32_t offset = hash(frame, y >> 4, seed_);
  const std::uint32_t row = (static_cast<std::uint32_t>(y) + (offset >> 16)) & (kGrain - 1);
  return {grain_[channel].data() + row * kGrain, static_cast<int>(offset & (kGrain - 1))};
}

// Replaces light by code values, and repeats the last pixel, so that pairs of pixels are whole.
void Sensor::develop(LightRow& row) const {
  for (LinearRgb& pixel : row)
    for (int c = 0; c < 3; ++c) {
      const float exposed = std::min(std::max(pixel[c], 0.0F), kBrightest);
      pixel[c] = curve_[static_cast<std::size_t>(
          static_cast<int>(std::sqrt(exposed * (1 / kBrightest)) * kCurve + 0.5F))];
    }
  row.push_back(row.back());
}

void Sensor::expose_luma(const LightRow& codes, const Grain& grain, std::uint16_t* luma) const {
  for (int x = 0; x < width_; ++x) {
    const LinearRgb& c = codes[static_cast<std::size_t>(x)];
    const float value = 16 + (65.481F * c[0] + 128.553F * c[1] + 24.966F * c[2]) / 255;
    const float spread = noise_ * (1.9F - 0.0045F * value);
    const float noisy = std::clamp(value + spread * grain.at(x), 0.0F, 255.0F);
    luma[x + 2] = static_cast<std::uint16_t>(static_cast<int>(noisy * 64 + 0.5F));
  }
  luma[0] = luma[1] = luma[2];
  luma[width_ + 2] = luma[width_ + 3] = luma[width_ + 1];
}

void Sensor::expose(int frame,
                    int y,
                    LightRow upper,
                    LightRow lower,
                    Exposure& exposure,
                    image::Picture& picture) const {
  develop(upper);
  develop(lower);
  std::uint16_t* luma = exposure.data() + static_cast<std::size_t>(y) * stride();
  expose_luma(upper, grain(frame, y, 0), luma);
  if (y + 1 < height_) expose_luma(lower, grain(frame, y, 2), luma + stride());
  // The noise of blue is that of the left pixel of each pair, the noise of red that of the right
  // one.
  const Grain noise = grain(frame, y, 1);
  std::uint8_t* blue = picture.planes[1].row(y / 2);
  std::uint8_t* red = picture.planes[2].row(y / 2);
  for (int i = 0; i < (width_ + 1) / 2; ++i) {
    const auto x = static_cast<std::size_t>(2 * i);
    const LinearRgb c = 0.25F * (upper[x] + upper[x + 1] + lower[x] + lower[x + 1]);
    blue[i] = code(128 + (-37.797F * c[0] - 74.203F * c[1] + 112.0F * c[2]) / 255 +
                   0.8F * noise_ * noise.at(2 * i));
    red[i] = code(128 + (112.0F * c[0] - 93.786F * c[1] - 18.214F * c[2]) / 255 +
                  0.8F * noise_ * noise.at(std::min(2 * i + 1, width_ - 1)));
  }
}

void Sensor::sharpen(const Exposure& exposure, int y, image::Picture& picture) const {
  const auto row = [&](int at) {
    return exposure.data() + static_cast<std::size_t>(std::clamp(at, 0, height_ - 1)) * stride() +
           2;
  };
  const std::uint16_t* here = row(y);
  const std::uint16_t* above = row(y - 1);
  const std::uint16_t* below = row(y + 1);
  const std::uint16_t* far_above = row(y - 2);
  const std::uint16_t* far_below = row(y + 2);
  const float side = ideal_ ? 0 : 0.07F;
  const float middle = 1 - 4 * side;
  const float gain = ideal_ ? 0 : 0.22F;
  std::uint8_t* out = picture.planes[0].row(y);
  for (int x = 0; x < width_; ++x) {
    const int near = here[x - 1] + here[x + 1] + above[x] + below[x];
    const int far = here[x - 2] + here[x + 2] + far_above[x] + far_below[x];
    const float soft = middle * static_cast<float>(here[x]) + side * static_cast<float>(near);
    out[x] = code((soft + gain * (soft - 0.25F * static_cast<float>(far))) / 64);
  }
}

}  // namespace airtruth::synthetic
