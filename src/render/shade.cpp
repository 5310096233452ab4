// SPDX-License-Identifier: Apache-2.0
#include "render/shade.h"

#include <algorithm>
#include <cmath>

namespace airtruth::render {
namespace {

using Texel = std::array<float, 4>;

int wrapped(int i, int size, bool repeat) {
  return repeat ? ((i % size) + size) % size : std::clamp(i, 0, size - 1);
}

Texel bilinear(const aircraft::Texture& texture, std::size_t index, float u, float v) {
  const auto& level = texture.levels[index];
  const float x = u * static_cast<float>(level.width) - 0.5f;
  const float y = v * static_cast<float>(level.height) - 0.5f;
  const float x_floor = std::floor(x);
  const float y_floor = std::floor(y);
  const float fx = x - x_floor;
  const float fy = y - y_floor;
  const int x0 = wrapped(static_cast<int>(x_floor), level.width, texture.repeat_u);
  const int x1 = wrapped(static_cast<int>(x_floor) + 1, level.width, texture.repeat_u);
  const int y0 = wrapped(static_cast<int>(y_floor), level.height, texture.repeat_v);
  const int y1 = wrapped(static_cast<int>(y_floor) + 1, level.height, texture.repeat_v);
  const auto at = [&](int i, int j) -> const Texel& {
    return level.texels[static_cast<std::size_t>(j) * static_cast<std::size_t>(level.width) +
                        static_cast<std::size_t>(i)];
  };
  Texel result;
  for (std::size_t c = 0; c < 4; ++c)
    result[c] = (1 - fy) * ((1 - fx) * at(x0, y0)[c] + fx * at(x1, y0)[c]) +
                fy * ((1 - fx) * at(x0, y1)[c] + fx * at(x1, y1)[c]);
  return result;
}

// Trilinear (Williams 1983).
Texel texel_at(const Placed& placed, const Hit& hit, float footprint_m) {
  const aircraft::Mesh& mesh = placed.model->mesh;
  const auto part = static_cast<std::size_t>(hit.part);
  const aircraft::Triangle& triangle = mesh.parts[part].triangles[hit.triangle];
  const int index = mesh.materials[triangle.material].texture;
  if (index < 0) return {1, 1, 1, 1};
  const aircraft::Texture& texture = mesh.textures[static_cast<std::size_t>(index)];
  const auto& [a, b, c] = triangle.vertex;
  const Eigen::Vector2f uv =
      (1 - hit.u - hit.v) * mesh.uvs[a] + hit.u * mesh.uvs[b] + hit.v * mesh.uvs[c];
  if (!uv.allFinite() || uv.cwiseAbs().maxCoeff() > 1e6f) return {1, 1, 1, 1};
  const float texels = footprint_m * placed.model->texels_per_m[part][hit.triangle];
  const float deepest = static_cast<float>(texture.levels.size() - 1);
  const float level = std::clamp(texels > 1 ? std::log2(texels) : 0.0f, 0.0f, deepest);
  const auto low = static_cast<std::size_t>(level);
  const Texel near = bilinear(texture, low, uv.x(), uv.y());
  const float t = level - static_cast<float>(low);
  if (t == 0) return near;
  const Texel far = bilinear(texture, low + 1, uv.x(), uv.y());
  Texel result;
  for (std::size_t i = 0; i < 4; ++i) result[i] = near[i] + t * (far[i] - near[i]);
  return result;
}

bool in_shadow(const Placed& placed, const Eigen::Vector3f& point_in_body) {
  for (std::size_t i = 0; i < placed.model->scenes.size(); ++i) {
    const Eigen::Vector3f o = placed.part_from_body[i] * point_in_body;
    const Eigen::Vector3f d = placed.part_from_body[i].linear() * placed.to_sun_in_body;
    RTCRay ray{};
    ray.org_x = o.x(), ray.org_y = o.y(), ray.org_z = o.z();
    ray.dir_x = d.x(), ray.dir_y = d.y(), ray.dir_z = d.z();
    ray.tnear = 0;
    ray.tfar = INFINITY;
    ray.mask = 0xffffffffu;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    // A propeller's disc is mostly air: what spins casts no shadow.
    if (placed.model->mesh.parts[i].spins) continue;
    rtcOccluded1(placed.model->scenes[i].get(), &context, &ray);
    if (ray.tfar < 0) return true;
  }
  return false;
}

}  // namespace

float opacity_at(const Placed& placed, const Hit& hit, float footprint_m) {
  const aircraft::Mesh& mesh = placed.model->mesh;
  const auto part = static_cast<std::size_t>(hit.part);
  if (placed.model->opaque[part][hit.triangle] != 0) return 1;
  const auto& triangle = mesh.parts[part].triangles[hit.triangle];
  const aircraft::Material& material = mesh.materials[triangle.material];
  const bool textured = material.texture >= 0 &&
                        mesh.textures[static_cast<std::size_t>(material.texture)].has_translucency;
  const float alpha = material.opacity * (textured ? texel_at(placed, hit, footprint_m)[3] : 1.0f);
  return alpha >= aircraft::kOpaque ? 1.0f : alpha;
}

std::array<float, 3> shade(const Placed& placed,
                           const BodyRay& ray,
                           const Hit& hit,
                           const Light& light,
                           float footprint_m) {
  const aircraft::Mesh& mesh = placed.model->mesh;
  const auto part = static_cast<std::size_t>(hit.part);
  const aircraft::Triangle& triangle = mesh.parts[part].triangles[hit.triangle];
  const aircraft::Material& material = mesh.materials[triangle.material];
  const auto& [a, b, c] = triangle.vertex;
  const auto linear = placed.body_from_part[part].linear();
  Eigen::Vector3f face =
      linear * (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
  face.normalize();
  if (face.dot(ray.direction) > 0) face = -face;
  Eigen::Vector3f normal = linear * ((1 - hit.u - hit.v) * mesh.normals[a] +
                                     hit.u * mesh.normals[b] + hit.v * mesh.normals[c]);
  if (!(normal.norm() > 1e-6f)) normal = face;
  normal.normalize();
  if (normal.dot(face) < 0) normal = -normal;

  const Eigen::Vector3f point = ray.origin + hit.t * ray.direction;
  const Eigen::Vector3f& to_sun = placed.to_sun_in_body;
  float sun = 0;
  const float cosine = normal.dot(to_sun);
  if (cosine > 0 && face.dot(to_sun) > 0 && !in_shadow(placed, point + 0.01f * face)) sun = cosine;
  const float upward = 0.5f * (1 + normal.dot(placed.up_in_body));
  float glint = 0;
  if (sun > 0 && material.shininess > 0) {
    const Eigen::Vector3f half = (to_sun - ray.direction).normalized();
    const float exponent = std::clamp(material.shininess, 4.0f, 128.0f);
    // Normalised so that a shinier surface is smaller and brighter, not brighter alone.
    glint = (exponent + 8) / 25.0f * std::pow(std::max(0.0f, normal.dot(half)), exponent) * sun;
  }
  Texel texel = texel_at(placed, hit, footprint_m);
  // A coarse level mixes in the holes beside an opaque triangle's own texels.
  if (placed.model->opaque[part][hit.triangle] != 0 && texel[3] > 0 && texel[3] < 1) {
    const float alpha = texel[3];
    for (float& channel : texel) channel = std::min(1.0f, channel / alpha);
  }
  std::array<float, 3> rgb{};
  constexpr float kGlossShare =
      0.08f;  // painted metal; the files' own specular colours are the game's taste
  for (std::size_t i = 0; i < 3; ++i) {
    const float ambient = light.ground[i] + upward * (light.sky[i] - light.ground[i]);
    const float albedo = material.diffuse[i] * texel[i];
    rgb[i] =
        material.opacity * (albedo * (sun * light.sun[i] + ambient) +
                            texel[3] * kGlossShare * material.specular[i] * glint * light.sun[i]);
  }
  return rgb;
}

}  // namespace airtruth::render
