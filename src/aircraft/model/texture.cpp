// SPDX-License-Identifier: Apache-2.0
#include "aircraft/model/texture.h"

#include <algorithm>
#include <utility>

#include "foundation/base/huge_pages.h"
#include "foundation/image/colour.h"

namespace airtruth::model {
namespace {

// Half of a level of that size; texel_at(x, y) has the level's texels.
template <typename TexelAt>
Texture::Level halved(int width, int height, const TexelAt& texel_at) {
  Texture::Level half;
  half.width = std::max(1, width / 2);
  half.height = std::max(1, height / 2);
  const std::size_t count = pixels_in(half.width, half.height);
  // Textures are large: 4 MiB for the first coarser level of 1024x1024 texels.
  half.texels.reserve(count);
  ask_for_huge_pages(half.texels.data(), count * sizeof(Texel));
  for (int y = 0; y < half.height; ++y) {
    const int lower = std::min(2 * y + 1, height - 1);
    for (int x = 0; x < half.width; ++x) {
      const int right = std::min(2 * x + 1, width - 1);
      const Texel p = texel_at(2 * x, 2 * y);
      const Texel q = texel_at(right, 2 * y);
      const Texel r = texel_at(2 * x, lower);
      const Texel s = texel_at(right, lower);
      Texel& target = half.texels.emplace_back();
      for (std::size_t c = 0; c < 4; ++c) target[c] = 0.25f * (p[c] + q[c] + r[c] + s[c]);
    }
  }
  return half;
}

Texture::Level halved(const Texture::Level& level) {
  return halved(level.width, level.height, [&](int x, int y) {
    return level.texels[index_in(level.width, x, y)];
  });
}

void add_mip_chain(Texture& texture) {
  const texture_file::Picture& finest = texture.finest;
  if (finest.width <= 1 && finest.height <= 1) return;
  texture.coarser.push_back(halved(finest.width, finest.height, [&](int x, int y) {
    return kDecoding.texel(finest_bytes(texture, x, y));
  }));
  while (texture.coarser.back().width > 1 || texture.coarser.back().height > 1)
    texture.coarser.push_back(halved(texture.coarser.back()));
}

}  // namespace

const Decoding kDecoding = [] {
  Decoding result;
  for (std::size_t i = 0; i < 256; ++i) {
    const float stated = static_cast<float>(i) / 255.0f;
    result.linear[i] = image::linear_from_srgb(stated);
    result.alpha[i] = stated < kOpaque ? stated : 1.0f;
  }
  return result;
}();

Texture texture_from_picture(texture_file::Picture picture, bool repeat_u, bool repeat_v) {
  Texture texture;
  texture.finest = std::move(picture);
  texture.repeat_u = repeat_u;
  texture.repeat_v = repeat_v;
  std::uint8_t least = 255;
  for (std::size_t i = 3; i < texture.finest.rgba.size(); i += 4)
    least = std::min(least, texture.finest.rgba[i]);
  texture.has_translucency = kDecoding.alpha[least] < kOpaque;
  add_mip_chain(texture);
  return texture;
}

float alpha_at(const Texture& texture, float u, float v) {
  return is_sound({u, v}) ? finest_alpha(texture, {u, v}) : 1;
}

}  // namespace airtruth::model
