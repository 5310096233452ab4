// SPDX-License-Identifier: Apache-2.0
#include "picture/shade/texture.h"

#include <algorithm>
#include <cmath>

#include "aircraft/model/texture.h"

namespace airtruth::shade {
namespace {

// Four channels at once.
using Channels = Eigen::Array4f;

Channels finest_at(const model::Texture& texture, const Eigen::Vector2f& uv) {
  const texture_file::Picture& finest = texture.finest;
  return model::bilinear<Channels>(
      texture, finest.width, finest.height, uv, [&](int i, int j) -> Channels {
        const Texel texel = model::kDecoding.texel(model::finest_bytes(texture, i, j));
        return Eigen::Map<const Channels>(texel.data());
      });
}

Channels coarser_at(const model::Texture& texture, std::size_t index, const Eigen::Vector2f& uv) {
  const model::Texture::Level& level = texture.coarser[index];
  return model::bilinear<Channels>(texture, level.width, level.height, uv, [&](int i, int j) {
    return Eigen::Map<const Channels>(level.texels[index_in(level.width, i, j)].data());
  });
}

}  // namespace

TriangleTexture::TriangleTexture(const model::Mesh& mesh, const Facet& facet, float footprint_m)
    : facet_(&facet), texture_(mesh.texture_of(mesh.materials[facet.material])) {
  if (texture_ == nullptr) return;
  const float texels = footprint_m * facet.texels_per_m;
  const float deepest = static_cast<float>(texture_->coarser.size());
  const float level = std::clamp(texels > 1 ? std::log2(texels) : 0.0f, 0.0f, deepest);
  level_ = static_cast<std::size_t>(level + 0.5f);
}

Eigen::Vector2f TriangleTexture::uv(float u, float v) const {
  return (1 - u - v) * facet_->uv[0] + u * facet_->uv[1] + v * facet_->uv[2];
}

float TriangleTexture::alpha(float u, float v) const {
  if (texture_ == nullptr) return 1;
  const Eigen::Vector2f at = uv(u, v);
  if (!model::is_sound(at)) return 1;
  return level_ == 0 ? model::finest_alpha(*texture_, at)
                     : coarser_at(*texture_, level_ - 1, at)[3];
}

Texel TriangleTexture::albedo(float u, float v) const {
  if (texture_ == nullptr) return {1, 1, 1, 1};
  const Eigen::Vector2f at = uv(u, v);
  if (!model::is_sound(at)) return {1, 1, 1, 1};
  Texel result;
  Eigen::Map<Channels> channels(result.data());
  channels = level_ == 0 ? finest_at(*texture_, at) : coarser_at(*texture_, level_ - 1, at);
  if (const float alpha = channels[3]; facet_->is_opaque && alpha > 0 && alpha < 1)
    channels = (channels / alpha).min(1.0f);
  return result;
}

}  // namespace airtruth::shade
