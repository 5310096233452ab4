// SPDX-License-Identifier: Apache-2.0
#include "aircraft/model/texture.h"

#include <algorithm>
#include <cmath>

#include "foundation/base/huge_pages.h"

namespace airtruth::model {
namespace {

using Texel = std::array<float, 4>;

// Textures are large: 16 MiB for the first level of 1024x1024 texels.
void reserve(std::vector<Texel>& texels, std::size_t count) {
  texels.reserve(count);
  ask_for_huge_pages(texels.data(), count * sizeof(Texel));
}

Texture::Level halved(const Texture::Level& level) {
  Texture::Level half;
  half.width = std::max(1, level.width / 2);
  half.height = std::max(1, level.height / 2);
  reserve(half.texels,
          static_cast<std::size_t>(half.width) * static_cast<std::size_t>(half.height));
  const auto row_at = [&](int y) {
    return level.texels.data() + static_cast<std::size_t>(std::min(y, level.height - 1)) *
                                     static_cast<std::size_t>(level.width);
  };
  for (int y = 0; y < half.height; ++y) {
    const Texel* upper = row_at(2 * y);
    const Texel* lower = row_at(2 * y + 1);
    for (int x = 0; x < half.width; ++x) {
      const auto left = static_cast<std::size_t>(2 * x);  // both are in the row, or it has one
      const auto right = static_cast<std::size_t>(std::min(2 * x + 1, level.width - 1));
      Texel& target = half.texels.emplace_back();
      for (std::size_t c = 0; c < 4; ++c)
        target[c] = 0.25f * (upper[left][c] + upper[right][c] + lower[left][c] + lower[right][c]);
    }
  }
  return half;
}

void add_mip_chain(Texture& texture) {
  while (texture.levels.back().width > 1 || texture.levels.back().height > 1)
    texture.levels.push_back(halved(texture.levels.back()));
}

int wrapped(int i, int size, bool repeat) {
  return repeat ? ((i % size) + size) % size : std::clamp(i, 0, size - 1);
}

}  // namespace

float linear_channel(float srgb) {
  const float c = std::clamp(srgb, 0.0f, 1.0f);
  return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

Texture texture_from_picture(const texture_file::Picture& picture, bool repeat_u, bool repeat_v) {
  Texture texture;
  texture.repeat_u = repeat_u;
  texture.repeat_v = repeat_v;
  std::array<float, 256> linear;
  std::array<float, 256> alpha;
  for (std::size_t i = 0; i < 256; ++i) {
    const float stated = static_cast<float>(i) / 255.0f;
    linear[i] = linear_channel(stated);
    alpha[i] = stated < kOpaque ? stated : 1.0f;
  }
  std::vector<Texel> texels;
  reserve(texels, picture.rgba.size() / 4);
  // A row at a time: a vector of this size would be cleared before it is filled.
  std::vector<Texel> row(static_cast<std::size_t>(picture.width));
  const std::uint8_t* p = picture.rgba.data();
  float least = 1;
  for (int y = 0; y < picture.height; ++y) {
    for (Texel& texel : row) {
      const float a = alpha[p[3]];
      least = std::min(least, a);
      texel = {a * linear[p[0]], a * linear[p[1]], a * linear[p[2]], a};
      p += 4;
    }
    texels.insert(texels.end(), row.begin(), row.end());
  }
  texture.has_translucency = least < kOpaque;
  texture.levels.push_back({picture.width, picture.height, std::move(texels)});
  add_mip_chain(texture);
  return texture;
}

float alpha_at(const Texture& texture, float u, float v) {
  const Texture::Level& level = texture.levels.front();
  if (!std::isfinite(u) || !std::isfinite(v) || std::abs(u) > 1e6f || std::abs(v) > 1e6f) return 1;
  const float x = u * static_cast<float>(level.width) - 0.5f;
  const float y = v * static_cast<float>(level.height) - 0.5f;
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  const float fx = x - static_cast<float>(x0);
  const float fy = y - static_cast<float>(y0);
  const auto at = [&](int i, int j) {
    return level.texels[static_cast<std::size_t>(wrapped(j, level.height, texture.repeat_v)) *
                            static_cast<std::size_t>(level.width) +
                        static_cast<std::size_t>(wrapped(i, level.width, texture.repeat_u))][3];
  };
  return (1 - fy) * ((1 - fx) * at(x0, y0) + fx * at(x0 + 1, y0)) +
         fy * ((1 - fx) * at(x0, y0 + 1) + fx * at(x0 + 1, y0 + 1));
}

}  // namespace airtruth::model
