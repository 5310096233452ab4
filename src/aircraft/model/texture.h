// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "aircraft/model/mesh.h"
#include "aircraft/texture_file/picture.h"
#include "foundation/geometry/box.h"

namespace airtruth::model {

// What the code values of a picture mean.
struct Decoding {
  std::array<float, 256> linear;
  std::array<float, 256> alpha;  // 1 from kOpaque on
  // Of 4 bytes of sRGB with straight alpha.
  Texel texel(const std::uint8_t* rgba) const {
    const float a = alpha[rgba[3]];
    return {a * linear[rgba[0]], a * linear[rgba[1]], a * linear[rgba[2]], a};
  }
};
extern const Decoding kDecoding;

// The 4 bytes of a texel of the finest level.
inline const std::uint8_t* finest_bytes(const Texture& texture, int x, int y) {
  return texture.finest.rgba.data() + 4 * index_in(texture.finest.width, x, y);
}

// A texel beyond the sides of a level, taken to the one that stands for it.
inline int wrapped(int i, int size, bool repeat) {
  if (i >= 0 && i < size) return i;
  return repeat ? ((i % size) + size) % size : std::clamp(i, 0, size - 1);
}

// Texture coordinates beyond this number of repeats count as damaged. Textures have at most 2^14
// texels a side, so an int holds their texels.
inline constexpr float kFarthestRepeat = 1e5f;
inline bool is_sound(const Eigen::Vector2f& uv) {
  return uv.allFinite() && uv.cwiseAbs().maxCoeff() <= kFarthestRepeat;
}

// A place between two texels: the first of them, and the share of the second.
struct TexelPlace {
  int first;
  float share;
};

// Of sound coordinates. std::floor is a call of the library on machines that are only known to have
// SSE2.
inline TexelPlace texel_place(float place) {
  const auto towards_zero = static_cast<std::int64_t>(place);
  const std::int64_t below = towards_zero - (place < static_cast<float>(towards_zero) ? 1 : 0);
  return {static_cast<int>(below), place - static_cast<float>(below)};
}

// Of a level of that size; at(x, y) has the value of a texel.
template <typename Value, typename At>
Value bilinear(
    const Texture& texture, int width, int height, const Eigen::Vector2f& uv, const At& at) {
  const auto [x, fx] = texel_place(uv.x() * static_cast<float>(width) - 0.5f);
  const auto [y, fy] = texel_place(uv.y() * static_cast<float>(height) - 0.5f);
  const int x0 = wrapped(x, width, texture.repeat_u);
  const int x1 = wrapped(x + 1, width, texture.repeat_u);
  const int y0 = wrapped(y, height, texture.repeat_v);
  const int y1 = wrapped(y + 1, height, texture.repeat_v);
  return (1 - fy) * ((1 - fx) * at(x0, y0) + fx * at(x1, y0)) +
         fy * ((1 - fx) * at(x0, y1) + fx * at(x1, y1));
}

inline float finest_alpha(const Texture& texture, const Eigen::Vector2f& uv) {
  const texture_file::Picture& finest = texture.finest;
  return bilinear<float>(texture, finest.width, finest.height, uv, [&](int i, int j) {
    return kDecoding.alpha[finest_bytes(texture, i, j)[3]];
  });
}

Texture texture_from_picture(texture_file::Picture picture, bool repeat_u, bool repeat_v);

// The alpha of the finest level at (u, v), interpolated bilinearly. Beyond 0..1 the texture
// repeats or its border continues, by repeat_u and repeat_v.
float alpha_at(const Texture& texture, float u, float v);

}  // namespace airtruth::model
