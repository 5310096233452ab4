// SPDX-License-Identifier: Apache-2.0
#include "dataset/stream/other_camera.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "picture/composite/sensor.h"
#include "picture/composite/spread.h"
#include "picture/video/patch_codec.h"

namespace airtruth::stream {
namespace {

// A plane's samples as numbers.
struct Values {
  int width = 0;
  int height = 0;
  std::vector<float> at;
};

Values values_of(const image::Plane& plane) {
  Values values{plane.width, plane.height, {}};
  values.at.reserve(static_cast<std::size_t>(plane.width) * static_cast<std::size_t>(plane.height));
  for (int y = 0; y < plane.height; ++y)
    values.at.insert(values.at.end(), plane.row(y), plane.row(y) + plane.width);
  return values;
}

void write(const Values& values, float low, float high, image::Plane& plane) {
  const float* value = values.at.data();
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x)
      plane.row(y)[x] = static_cast<std::uint8_t>(std::lround(std::clamp(*value++, low, high)));
}

// The share of a kernel that lies within a side of `length`, about each place.
std::vector<float> shares_within(const std::vector<float>& kernel, int length) {
  const auto reach = static_cast<int>(kernel.size() / 2);
  std::vector<float> shares(static_cast<std::size_t>(length));
  for (int i = 0; i < length; ++i)
    for (int k = std::max(-reach, -i); k <= std::min(reach, length - 1 - i); ++k)
      shares[static_cast<std::size_t>(i)] += kernel[static_cast<std::size_t>(k + reach)];
  return shares;
}

// A Gaussian of these deviations in samples, as the weighted mean of what lies within the plane: an
// even plane stays as it is, at its rim, too.
void soften(Values& values, double across, double down) {
  if (!(across > 0)) return;
  const std::vector<float> along_rows = composite::gaussian(across);
  const std::vector<float> along_columns = composite::gaussian(down);
  composite::blur(values.at, values.width, values.height, along_rows, along_columns);
  const std::vector<float> of_columns = shares_within(along_rows, values.width);
  const std::vector<float> of_rows = shares_within(along_columns, values.height);
  float* value = values.at.data();
  for (const float of_row : of_rows)
    for (const float of_column : of_columns) *value++ /= of_row * of_column;
}

void add_noise(Values& values, const OtherCamera& camera, std::uint64_t seed) {
  if (!(camera.noise > 0)) return;
  const std::vector<float> field = composite::noise_field(
      {0, 0, values.width, values.height}, seed, 0, camera.noise_correlation_px);
  for (std::size_t i = 0; i < field.size(); ++i)
    values.at[i] += static_cast<float>(camera.noise) * std::sqrt(2 * values.at[i]) * field[i];
}

void sharpen(Values& values, double amount) {
  if (!(amount > 0)) return;
  Values soft = values;
  soften(soft, 1, 1);
  for (std::size_t i = 0; i < values.at.size(); ++i)
    values.at[i] += static_cast<float>(amount) * (values.at[i] - soft.at[i]);
}

// A plane of luma, or of red, green or blue, whose codes go from `low` to `high`.
void show_light(
    const OtherCamera& camera, float low, float high, std::uint64_t seed, image::Plane& plane) {
  Values values = values_of(plane);
  soften(values, camera.spread_px, camera.spread_px);
  const auto gamma = static_cast<float>(camera.gamma);
  for (float& value : values.at) {
    const float light = std::clamp((value - low) / (high - low), 0.0F, 1.0F);
    value = std::min(1.0F, static_cast<float>(camera.gain) * std::pow(light, gamma));
  }
  add_noise(values, camera, seed);
  sharpen(values, camera.sharpening);
  for (float& value : values.at) value = low + value * (high - low);
  write(values, low, high, plane);
}

void show_chroma(const OtherCamera& camera,
                 image::Chroma chroma,
                 float low,
                 float high,
                 double tint,
                 image::Plane& plane) {
  Values values = values_of(plane);
  const double spread_px = std::hypot(camera.spread_px, camera.chroma_spread_px);
  soften(values,
         spread_px / (1 << image::log2_chroma_width(chroma)),
         spread_px / (1 << image::log2_chroma_height(chroma)));
  for (float& value : values.at)
    value = 128 + static_cast<float>(camera.saturation) * (value - 128) + static_cast<float>(tint);
  write(values, low, high, plane);
}

// Nothing predicts the picture: the reference is grey.
void encode(int quantiser, image::Picture& picture) {
  const int even_width = picture.width - picture.width % 2;
  const int even_height = picture.height - picture.height % 2;
  if (quantiser == 0 || even_width == 0 || even_height == 0 ||
      !video::PatchCodec::can_code(picture.colour))
    return;
  const image::Picture part = image::crop(picture, {0, 0, even_width, even_height});
  image::Picture grey = image::make_picture(even_width, even_height, picture.colour);
  for (int i = 0; i < grey.plane_count; ++i) {
    image::Plane& plane = grey.planes[static_cast<std::size_t>(i)];
    for (int y = 0; y < plane.height; ++y) std::fill_n(plane.row(y), plane.width, 128);
  }
  image::paste(picture, video::PatchCodec(quantiser).coded(part, grey), 0, 0);
}

}  // namespace

// The ranges are chosen by eye: no measurement says how far the cameras of the world differ. Three
// of ten cameras do not code.
OtherCamera drawn_camera(Random random) {
  OtherCamera camera;
  camera.spread_px = random.uniform(0, 0.8);
  camera.gamma = std::exp(random.uniform(-0.22, 0.22));
  camera.gain = random.uniform(0.85, 1.15);
  const double noisy = random.uniform();
  camera.noise = 0.025 * noisy * noisy;
  camera.noise_correlation_px = random.uniform(0, 1);
  camera.sharpening = random.uniform(0, 0.6);
  camera.saturation = random.uniform(0.5, 1.4);
  camera.chroma_spread_px = random.uniform(0, 2.5);
  for (double& tint : camera.tint) tint = random.uniform(-6, 6);
  if (random.uniform() > 0.3) camera.quantiser = static_cast<int>(random.uniform(18, 37));
  return camera;
}

image::Picture seen_through(const OtherCamera& camera,
                            const image::Picture& picture,
                            std::uint64_t seed) {
  image::Picture shown = picture.clone();
  const bool is_full = picture.colour.range == image::Range::kFull;
  const float low = is_full ? 0 : 16;
  for (int i = 0; i < shown.plane_count; ++i) {
    image::Plane& plane = shown.planes[static_cast<std::size_t>(i)];
    if (i == 0 || picture.colour.matrix == image::Matrix::kRgb)
      show_light(camera, low, is_full ? 255 : 235, seed, plane);
    else
      show_chroma(camera,
                  picture.colour.chroma,
                  low,
                  is_full ? 255 : 240,
                  camera.tint[static_cast<std::size_t>(i - 1)],
                  plane);
  }
  encode(camera.quantiser, shown);
  return shown;
}

}  // namespace airtruth::stream
