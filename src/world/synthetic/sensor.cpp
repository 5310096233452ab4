// SPDX-License-Identifier: Apache-2.0
#include "world/synthetic/sensor.h"

#include <algorithm>
#include <cmath>

#include "foundation/base/seed.h"
#include "foundation/image/colour.h"

namespace airtruth::synthetic {
namespace {

constexpr int kCurve = 8192;
constexpr float kBrightest = 2.5F;
constexpr int kGrain = 256;
constexpr float kSharpening = 0.22F;

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
  return static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
}

}  // namespace

Sensor::Sensor(const FlightOptions& options, std::uint32_t seed)
    : width_(options.width),
      height_(options.height),
      noise_(options.ideal_sensor ? 0 : static_cast<float>(options.noise)),
      ideal_(options.ideal_sensor),
      seed_(seed),
      curve_(tone_curve(options.linear_light)),
      grain_(std::size_t{kGrain} * kGrain) {
  Random random(seed_);
  const auto normal = [&] { return static_cast<float>(random.normal()); };
  for (LinearRgb& g : grain_) g = {normal(), normal(), normal(), 0.0F};
}

Sensor::Exposure Sensor::start() const {
  return {std::vector<std::uint16_t>(static_cast<std::size_t>(width_) *
                                     static_cast<std::size_t>(height_))};
}

LinearRgb Sensor::coded(const LinearRgb& light) const {
  const LinearRgb at = (light.max(0.0F).min(kBrightest) * (1 / kBrightest)).sqrt() * kCurve;
  const auto look = [&](int i) { return curve_[static_cast<std::size_t>(at[i] + 0.5F)]; };
  return {look(0), look(1), look(2), 0.0F};
}

// Every 16 rows use another part of the noise tile, so that no pattern repeats.
const LinearRgb& Sensor::grain(int frame, int x, int y) const {
  const std::uint32_t offset = hash(frame, y >> 4, seed_);
  const auto column = (static_cast<std::uint32_t>(x) + offset) & (kGrain - 1);
  const auto row = (static_cast<std::uint32_t>(y) + (offset >> 16)) & (kGrain - 1);
  return grain_[row * kGrain + column];
}

void Sensor::expose(int frame,
                    int y,
                    const LinearRgb* upper,
                    const LinearRgb* lower,
                    Exposure& exposure,
                    image::Picture& picture) const {
  const bool pair = y + 1 < height_;
  std::uint8_t* blue = picture.planes[1].row(y / 2);
  std::uint8_t* red = picture.planes[2].row(y / 2);
  const auto luma = [&](const LinearRgb& c, int x, int row, float grain) {
    const float value = 16 + (65.481F * c[0] + 128.553F * c[1] + 24.966F * c[2]) / 255;
    const float spread = noise_ * (1.9F - 0.0045F * value);
    const float noisy = std::clamp(value + spread * grain, 0.0F, 255.0F);
    exposure.luma[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                  static_cast<std::size_t>(x)] = static_cast<std::uint16_t>(noisy * 64 + 0.5F);
  };
  for (int x = 0; x < width_; x += 2) {
    const int right = std::min(x + 1, width_ - 1);
    const LinearRgb c00 = coded(upper[x]);
    const LinearRgb c01 = coded(upper[right]);
    const LinearRgb c10 = coded(lower[x]);
    const LinearRgb c11 = coded(lower[right]);
    const LinearRgb& g0 = grain(frame, x, y);
    const LinearRgb& g1 = grain(frame, right, y);
    luma(c00, x, y, g0[0]);
    luma(c01, right, y, g1[0]);
    if (pair) {
      luma(c10, x, y + 1, g0[2]);
      luma(c11, right, y + 1, g1[2]);
    }
    const LinearRgb mean = 0.25F * (c00 + c01 + c10 + c11);
    const float spread = 0.8F * noise_;
    blue[x / 2] = code(128 + (-37.797F * mean[0] - 74.203F * mean[1] + 112.0F * mean[2]) / 255 +
                       spread * g0[1]);
    red[x / 2] = code(128 + (112.0F * mean[0] - 93.786F * mean[1] - 18.214F * mean[2]) / 255 +
                      spread * g1[1]);
  }
}

void Sensor::sharpen(const Exposure& exposure, int y, image::Picture& picture) const {
  const auto row = [&](int at) {
    return exposure.luma.data() + static_cast<std::size_t>(std::clamp(at, 0, height_ - 1)) *
                                      static_cast<std::size_t>(width_);
  };
  const std::uint16_t* here = row(y);
  const std::uint16_t* above = row(y - 1);
  const std::uint16_t* below = row(y + 1);
  const std::uint16_t* far_above = row(y - 2);
  const std::uint16_t* far_below = row(y + 2);
  std::uint8_t* out = picture.planes[0].row(y);
  if (ideal_) {
    for (int x = 0; x < width_; ++x) out[x] = code(static_cast<float>(here[x]) / 64);
    return;
  }
  for (int x = 0; x < width_; ++x) {
    const int l = std::max(x - 1, 0);
    const int r = std::min(x + 1, width_ - 1);
    const int ll = std::max(x - 2, 0);
    const int rr = std::min(x + 2, width_ - 1);
    const int near = here[l] + here[r] + above[x] + below[x];
    const int far = here[ll] + here[rr] + far_above[x] + far_below[x];
    // First the lens's blur, then the camera's unsharp mask.
    const float soft = 0.72F * here[x] + 0.07F * static_cast<float>(near);
    const float sharp = soft + kSharpening * (soft - 0.25F * static_cast<float>(far));
    out[x] = code(sharp / 64);
  }
}

}  // namespace airtruth::synthetic
