// SPDX-License-Identifier: Apache-2.0
#include "picture/render/shade.h"

#include <algorithm>
#include <cmath>

#include "picture/render/coat.h"

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

// Trilinear texture look-up (Williams 1983).
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

namespace {

// A point of the surface in body coordinates, as the shading uses it.
struct Surface {
  // Unit vector towards the viewer's side.
  Eigen::Vector3f face;
  // Unit vector of the smooth surface, on the same side as `face`.
  Eigen::Vector3f normal;
  Openness openness;
};

Surface surface_at(const Placed& placed, const BodyRay& ray, const Hit& hit) {
  const aircraft::Mesh& mesh = placed.model->mesh;
  const auto part = static_cast<std::size_t>(hit.part);
  const auto& [a, b, c] = mesh.parts[part].triangles[hit.triangle].vertex;
  const auto linear = placed.body_from_part[part].linear();
  const std::array<float, 3> weights = {1 - hit.u - hit.v, hit.u, hit.v};
  Surface surface;
  surface.face =
      linear * (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
  surface.face.normalize();
  const bool is_back = surface.face.dot(ray.direction) > 0;
  if (is_back) surface.face = -surface.face;
  surface.normal = linear * (weights[0] * mesh.normals[a] + weights[1] * mesh.normals[b] +
                             weights[2] * mesh.normals[c]);
  if (!(surface.normal.norm() > 1e-6f)) surface.normal = surface.face;
  surface.normal.normalize();
  if (surface.normal.dot(surface.face) < 0) surface.normal = -surface.normal;
  const TriangleOpenness& openness = placed.model->openness[part][hit.triangle];
  const SideOpenness& side = is_back ? openness.back : openness.front;
  surface.openness = side.at(hit.u, hit.v);
  return surface;
}

Texel albedo_texel(const Placed& placed, const Hit& hit, float footprint_m) {
  Texel texel = texel_at(placed, hit, footprint_m);
  // A coarse mip level mixes holes into an opaque triangle's own texels.
  const bool is_opaque =
      placed.model->opaque[static_cast<std::size_t>(hit.part)][hit.triangle] != 0;
  if (is_opaque && texel[3] > 0 && texel[3] < 1) {
    const float alpha = texel[3];
    for (float& channel : texel) channel = std::min(1.0f, channel / alpha);
  }
  return texel;
}

// Blinn-Phong with a normalisation: a shinier surface has a smaller and brighter glint.
float glint_of(const Surface& surface,
               const Eigen::Vector3f& to_sun,
               const Eigen::Vector3f& view,
               float shininess) {
  if (!(shininess > 0)) return 0;
  const Eigen::Vector3f half = (to_sun - view).normalized();
  const float exponent = std::clamp(shininess, 4.0f, 128.0f);
  return (exponent + 8) / 25.0f * std::pow(std::max(0.0f, surface.normal.dot(half)), exponent);
}

// Light of the surroundings: what reaches the paint (over pi), and what its clear coat mirrors.
struct Around {
  Rgb diffuse{};
  Rgb mirrored{};
};

// Light that the aircraft's own paint reflects to the surface, over pi.
Rgb given_back(const Placed& placed, const Eigen::Vector3f& share_towards, const Light& light) {
  const float share = share_towards.norm();
  if (!(share > 1e-3f)) return {};
  Rgb result =
      light.surroundings->irradiance_over_pi(placed.world_from_body * (share_towards / share));
  const float sun = std::max(0.0f, share_towards.dot(placed.to_sun_in_body));
  for (std::size_t i = 0; i < 3; ++i) result[i] = share * result[i] + sun * light.sun[i];
  return result;
}

// The aircraft hides a share of the light of the surroundings and reflects some of its own. The
// mean direction of the remaining light leans away from the hiding parts.
Around light_around(const Placed& placed,
                    const Surface& surface,
                    const Eigen::Vector3f& mirror,
                    const Light& light) {
  // From this open share on, nothing counts as hidden.
  constexpr float kNothingHidden = 0.999f;
  const float open = surface.openness.share;
  Around around;
  around.mirrored = light.surroundings->radiance(placed.world_from_body * mirror);
  if (open > kNothingHidden) {
    around.diffuse =
        light.surroundings->irradiance_over_pi(placed.world_from_body * surface.normal);
    return around;
  }
  // The directions about the smooth normal lean in the same way as those about the face's normal.
  const Eigen::Vector3f lean =
      surface.openness.towards + 2 * open / 3 * (surface.normal - surface.face);
  const Eigen::Vector3f towards = lean.norm() > 1e-6f ? lean.normalized() : surface.normal;
  around.diffuse = light.surroundings->irradiance_over_pi(placed.world_from_body * towards);
  const Rgb own = given_back(placed, surface.openness.given_back, light);
  for (std::size_t i = 0; i < 3; ++i) {
    around.diffuse[i] = open * around.diffuse[i] + own[i];
    around.mirrored[i] = open * around.mirrored[i] + own[i];
  }
  return around;
}

// A sky whose colour changes linearly from ground to zenith (hemisphere lighting).
Rgb hemisphere(const Placed& placed, const Surface& surface, const Light& light) {
  const float upward = 0.5f * (1 + surface.normal.dot(placed.up_in_body));
  Rgb result;
  for (std::size_t i = 0; i < 3; ++i)
    result[i] = light.ground[i] + upward * (light.sky[i] - light.ground[i]);
  return result;
}

// Irradiance over pi on the paint for a sun of 1.
float sun_on(const Placed& placed, const Surface& surface, const Eigen::Vector3f& point) {
  const Eigen::Vector3f& to_sun = placed.to_sun_in_body;
  const float cosine = surface.normal.dot(to_sun);
  if (!(cosine > 0) || !(surface.face.dot(to_sun) > 0)) return 0;
  return is_blocked(*placed.model, point + 0.01f * surface.face, to_sun) ? 0 : cosine;
}

Rgb as_opengl(const Placed& placed,
              const Surface& surface,
              const aircraft::Material& material,
              const Texel& texel,
              float sun,
              const Eigen::Vector3f& view,
              const Light& light) {
  // Share of painted metal. It replaces the specular colours of the model files, which are chosen
  // for the look of the game.
  constexpr float kGlossShare = 0.08f;
  const float glint =
      sun > 0 ? sun * glint_of(surface, placed.to_sun_in_body, view, material.shininess) : 0;
  const Rgb around = hemisphere(placed, surface, light);
  Rgb rgb;
  for (std::size_t i = 0; i < 3; ++i)
    rgb[i] =
        material.opacity * (material.diffuse[i] * texel[i] * (sun * light.sun[i] + around[i]) +
                            texel[3] * kGlossShare * material.specular[i] * glint * light.sun[i]);
  return rgb;
}

// A surface that mirrors a share of the light and scatters part of the rest. Premultiplied.
Rgb coated(const Placed& placed,
           const Surface& surface,
           const aircraft::Material& material,
           const Texel& texel,
           float sun,
           const Eigen::Vector3f& view,
           const Light& light) {
  const Coat coat = coat_of(material, texel);
  const float cosine = std::clamp(-surface.normal.dot(view), 0.0f, 1.0f);
  const Eigen::Vector3f mirror = (view + 2 * cosine * surface.normal).normalized();
  const Around around = light_around(placed, surface, mirror, light);
  const Glint glint =
      sun > 0 ? sun_glint(surface.normal, placed.to_sun_in_body, view, coat.roughness) : Glint{};
  Rgb rgb;
  for (std::size_t i = 0; i < 3; ++i) {
    const float share = coat.mirrors ? mirror_share(coat.at_normal[i], cosine) : 0;
    const float of_sun =
        coat.mirrors ? mirror_share(coat.at_normal[i], glint.cosine) * glint.strength : 0;
    rgb[i] = coat.scattered[i] * (1 - share) * (sun * light.sun[i] + around.diffuse[i]) +
             coat.cover * (share * around.mirrored[i] + of_sun * light.sun[i]);
  }
  return rgb;
}

}  // namespace

std::array<float, 3> shade(const Placed& placed,
                           const BodyRay& ray,
                           const Hit& hit,
                           const Light& light,
                           float footprint_m) {
  const aircraft::Mesh& mesh = placed.model->mesh;
  const auto& triangle = mesh.parts[static_cast<std::size_t>(hit.part)].triangles[hit.triangle];
  const aircraft::Material& material = mesh.materials[triangle.material];
  const Surface surface = surface_at(placed, ray, hit);
  const float sun = sun_on(placed, surface, ray.origin + hit.t * ray.direction);
  const Texel texel = albedo_texel(placed, hit, footprint_m);
  if (light.surroundings)
    return coated(placed, surface, material, texel, sun, ray.direction, light);
  return as_opengl(placed, surface, material, texel, sun, ray.direction, light);
}

}  // namespace airtruth::render
