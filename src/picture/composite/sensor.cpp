// SPDX-License-Identifier: Apache-2.0
#include "picture/composite/sensor.h"

#include <cmath>

#include "foundation/base/seed.h"
#include "picture/composite/spread.h"

namespace airtruth::composite {
namespace {

// A normal number for a pixel of a frame: the sum of two times 8 uniform bytes (Irwin 1927 and Hall
// 1927), which never exceeds 6.9 standard deviations.
float normal_at(std::uint64_t key, int x, int y) {
  const std::uint64_t place = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32) |
                              static_cast<std::uint32_t>(y);
  const std::uint64_t a = mixed(key ^ Random(place)());
  const std::uint64_t b = Random(a)();
  int sum = 0;
  for (int i = 0; i < 8; ++i)
    sum += static_cast<int>(a >> (8 * i) & 255) + static_cast<int>(b >> (8 * i) & 255);
  // Mean, and the inverse of the standard deviation, of the sum of 16 uniform bytes.
  constexpr float kMean = 16 * 127.5F;
  static const float kScale = static_cast<float>(1 / std::sqrt(16 * (256.0 * 256.0 - 1) / 12));
  return (static_cast<float>(sum) - kMean) * kScale;
}

}  // namespace

int Sensor::halo_px() const {
  return sharpening > 0 ? static_cast<int>(gaussian(sharpening_px).size() / 2) : 0;
}

// The reach of the Gaussian in chroma samples, each of which is up to two pixels wide and starts at
// an odd or an even pixel.
int Sensor::chroma_px() const {
  if (!(chroma_spread_px > 0)) return 0;
  // Side of a halved chroma sample, in pixels.
  constexpr int kSample = 2;
  return kSample * static_cast<int>(gaussian(chroma_spread_px / kSample).size() / 2) + 1;
}

void sharpen(std::vector<float>& change,
             const PixelBox& patch,
             const PixelBox& frame,
             const Sensor& sensor) {
  if (!(sensor.sharpening > 0)) return;
  const std::vector<float> kernel = gaussian(sensor.sharpening_px);
  const std::vector<float> soft = blurred(change, patch, patch, frame, kernel, kernel);
  const auto amount = static_cast<float>(sensor.sharpening);
  for (std::size_t i = 0; i < change.size(); ++i) change[i] += amount * (change[i] - soft[i]);
}

float noise_sigma(float luma, float codes_per_unit, const Sensor& sensor) {
  const float bounded = std::clamp(luma, 0.0F, 1.0F);
  const float light = sensor.tone.linear_from_coded_clamped(bounded);
  // The slope of the coded value over light, by a finite difference over about one of 255 code
  // values on each side, in units of their range.
  constexpr float kStep = 0.004F;
  const float low = sensor.tone.linear_from_coded_clamped(bounded - kStep);
  const float high = sensor.tone.linear_from_coded_clamped(bounded + kStep);
  const float width = std::min(1.0F, bounded + kStep) - std::max(0.0F, bounded - kStep);
  const float slope = width / std::max(high - low, 1e-6F);
  const double variance = sensor.noise_gain * static_cast<double>(light) + sensor.noise_floor;
  return codes_per_unit * slope * static_cast<float>(std::sqrt(std::max(0.0, variance)));
}

std::vector<float> noise_field(const PixelBox& patch,
                               std::uint64_t seed,
                               std::int64_t frame,
                               double correlation_px) {
  const std::vector<float> kernel = gaussian(correlation_px);
  const int reach = static_cast<int>(kernel.size()) / 2;
  const PixelBox around = wider(patch, reach);
  const std::uint64_t key = mixed(seed ^ mixed(static_cast<std::uint64_t>(frame) + 1));
  std::vector<float> white;
  white.reserve(pixels_in(around));
  for (int y = around.y; y < around.bottom(); ++y)
    for (int x = around.x; x < around.right(); ++x) white.push_back(normal_at(key, x, y));
  if (reach == 0) return white;
  blur(white, around.width, around.height, kernel, kernel);
  double power = 0;
  for (const float weight : kernel)
    power += static_cast<double>(weight) * static_cast<double>(weight);
  // The power applies along both axes: sqrt(power)^2.
  const auto scale = static_cast<float>(1 / power);
  std::vector<float> field;
  field.reserve(pixels_in(patch));
  for (int y = patch.y; y < patch.bottom(); ++y)
    for (int x = patch.x; x < patch.right(); ++x)
      field.push_back(scale * white[index_in(around, x, y)]);
  return field;
}

}  // namespace airtruth::composite
