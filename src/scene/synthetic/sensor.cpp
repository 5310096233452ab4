// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/sensor.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "foundation/base/seed.h"
#include "foundation/geometry/box.h"
#include "foundation/image/colour.h"
#include "scene/synthetic/noise.h"
#include "scene/synthetic/rays.h"

namespace airtruth::synthetic {
namespace {

// Where a constant of this file states no origin, it is a choice: the world is invented.

// Number of steps of the tone curve.
constexpr int kCurve = 8192;
// Light at the end of the tone curve, where a linear sensor's white is 1.
constexpr float kBrightest = 2.5F;
// Pixels on each side of a tile of noise, a power of two.
constexpr int kGrain = 256;
// Amount of the unsharp mask, a ratio.
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

inline std::uint8_t code(float value) {
  return static_cast<std::uint8_t>(static_cast<int>(std::clamp(value + 0.5F, 0.0F, 255.0F)));
}

// Code values of a row, and of one pixel more, which repeats the last one.
struct Codes {
  float* red;
  float* green;
  float* blue;
};

AIRTRUTH_FOR_VECTORS
void develop(const float* __restrict light,
             const float* __restrict fall_off,
             const float* __restrict curve,
             int width,
             float* __restrict codes) {
  for (int x = 0; x < width; ++x) {
    const float exposed = std::min(std::max(light[x] * fall_off[x], 0.0F), kBrightest);
    codes[x] = std::sqrt(exposed * (1 / kBrightest)) * kCurve + 0.5F;
  }
  for (int x = 0; x < width; ++x) codes[x] = curve[static_cast<int>(codes[x])];
  codes[width] = codes[width - 1];
}

AIRTRUTH_FOR_VECTORS
void expose_luma(const Codes& codes,
                 const float* __restrict grain,
                 float noise,
                 int width,
                 std::uint16_t* __restrict luma) {
  const float* __restrict red = codes.red;
  const float* __restrict green = codes.green;
  const float* __restrict blue = codes.blue;
  for (int x = 0; x < width; ++x) {
    const float value = 16 + (65.481F * red[x] + 128.553F * green[x] + 24.966F * blue[x]) / 255;
    const float spread = noise * (1.9F - 0.0045F * value);
    const float noisy = std::clamp(value + spread * grain[x], 0.0F, 255.0F);
    luma[x] = static_cast<std::uint16_t>(static_cast<int>(noisy * 64 + 0.5F));
  }
}

inline float mean_of_four(const float* upper, const float* lower, int x) {
  return 0.25F * (upper[x] + upper[x + 1] + lower[x] + lower[x + 1]);
}

// The noise of blue is that of the left pixel of each pair, the noise of red that of the right one.
AIRTRUTH_FOR_VECTORS
void expose_chroma(const Codes& upper,
                   const Codes& lower,
                   const float* __restrict grain,
                   float spread,
                   int pairs,
                   std::uint8_t* __restrict blue,
                   std::uint8_t* __restrict red) {
  for (int i = 0; i < pairs; ++i) {
    const float r = mean_of_four(upper.red, lower.red, 2 * i);
    const float g = mean_of_four(upper.green, lower.green, 2 * i);
    const float b = mean_of_four(upper.blue, lower.blue, 2 * i);
    blue[i] = code(128 + (-37.797F * r - 74.203F * g + 112.0F * b) / 255 + spread * grain[2 * i]);
    red[i] = code(128 + (112.0F * r - 93.786F * g - 18.214F * b) / 255 + spread * grain[2 * i + 1]);
  }
}

// A row and its neighbours before sharpening.
struct Rows {
  const std::uint16_t* here;
  const std::uint16_t* above;
  const std::uint16_t* below;
  const std::uint16_t* far_above;
  const std::uint16_t* far_below;
};

// First the lens's blur, then the camera's unsharp mask. The last four are the columns beside x.
[[gnu::always_inline]] inline std::uint8_t sharpened(
    const Rows& rows, int x, int l, int r, int ll, int rr) {
  const int near = rows.here[l] + rows.here[r] + rows.above[x] + rows.below[x];
  const int far = rows.here[ll] + rows.here[rr] + rows.far_above[x] + rows.far_below[x];
  const float soft =
      0.72F * static_cast<float>(int{rows.here[x]}) + 0.07F * static_cast<float>(near);
  const float sharp = soft + kSharpening * (soft - 0.25F * static_cast<float>(far));
  return code(sharp / 64);
}

AIRTRUTH_FOR_VECTORS
void sharpen_middle(const Rows& given, int width, std::uint8_t* __restrict out) {
  const Rows rows = given;
  for (int x = 2; x < width - 2; ++x) out[x] = sharpened(rows, x, x - 1, x + 1, x - 2, x + 2);
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

// Every 16 rows use another part of the noise tile, so that no pattern repeats. Writes the noise of
// the row and of one pixel more.
void Sensor::copy_grain(int frame, int y, int channel, float* grain) const {
  const std::uint32_t offset = hash(frame, y >> 4, seed_);
  const std::uint32_t row = (static_cast<std::uint32_t>(y) + (offset >> 16)) & (kGrain - 1);
  const float* tile = grain_[static_cast<std::size_t>(channel)].data() + row * kGrain;
  auto column = static_cast<int>(offset & (kGrain - 1));
  for (int x = 0; x < width_;) {
    const int count = std::min(kGrain - column, width_ - x);
    std::copy_n(tile + column, count, grain + x);
    x += count;
    column = 0;
  }
  grain[width_] = grain[width_ - 1];
}

void Sensor::expose(int frame,
                    int y,
                    const Row& upper,
                    const Row& lower,
                    Exposure& exposure,
                    image::Picture& picture) const {
  const std::size_t room = static_cast<std::size_t>(width_) + 1;
  const auto memory = std::make_unique_for_overwrite<float[]>(7 * room);
  const auto part = [&](std::size_t i) { return memory.get() + i * room; };
  const auto developed = [&](const Row& row, std::size_t first) {
    const Codes codes{part(first), part(first + 1), part(first + 2)};
    develop(row.red.data(), row.fall_off.data(), curve_.data(), width_, codes.red);
    develop(row.green.data(), row.fall_off.data(), curve_.data(), width_, codes.green);
    develop(row.blue.data(), row.fall_off.data(), curve_.data(), width_, codes.blue);
    return codes;
  };
  const Codes above = developed(upper, 0);
  const Codes below = developed(lower, 3);
  float* grain = part(6);
  std::uint16_t* luma = exposure.data() + index_in(width_, 0, y);
  copy_grain(frame, y, 0, grain);
  expose_luma(above, grain, noise_, width_, luma);
  if (y + 1 < height_) {
    copy_grain(frame, y, 2, grain);
    expose_luma(below, grain, noise_, width_, luma + width_);
  }
  copy_grain(frame, y, 1, grain);
  expose_chroma(above,
                below,
                grain,
                0.8F * noise_,
                (width_ + 1) / 2,
                picture.planes[1].row(y / 2),
                picture.planes[2].row(y / 2));
}

void Sensor::sharpen(const Exposure& exposure, int y, image::Picture& picture) const {
  const auto row = [&](int at) {
    return exposure.data() + index_in(width_, 0, std::clamp(at, 0, height_ - 1));
  };
  const Rows rows{row(y), row(y - 1), row(y + 1), row(y - 2), row(y + 2)};
  std::uint8_t* out = picture.planes[0].row(y);
  if (ideal_) {
    for (int x = 0; x < width_; ++x) out[x] = code(static_cast<float>(rows.here[x]) / 64);
    return;
  }
  sharpen_middle(rows, width_, out);
  for (const int x : {0, 1, width_ - 2, width_ - 1})
    out[x] = sharpened(rows,
                       x,
                       std::max(x - 1, 0),
                       std::min(x + 1, width_ - 1),
                       std::max(x - 2, 0),
                       std::min(x + 2, width_ - 1));
}

}  // namespace airtruth::synthetic
