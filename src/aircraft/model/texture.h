// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "aircraft/model/mesh.h"
#include "aircraft/texture_file/picture.h"

namespace airtruth::model {

// The linear value of an sRGB value, both 0..1, by the exact curve of IEC 61966-2-1.
float linear_channel(float srgb);

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
  const auto width = static_cast<std::size_t>(texture.finest.width);
  return texture.finest.rgba.data() +
         4 * (static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x));
}

Texture texture_from_picture(texture_file::Picture picture, bool repeat_u, bool repeat_v);

// The alpha of the finest level at (u, v), interpolated bilinearly. Beyond 0..1 the texture
// repeats or its border continues, by repeat_u and repeat_v.
float alpha_at(const Texture& texture, float u, float v);

}  // namespace airtruth::model
