// SPDX-License-Identifier: Apache-2.0
#include "picture/render/shade.h"

#include <algorithm>
#include <cmath>

namespace airtruth::render {
namespace {

int wrapped(int i, int size, bool repeat) {
  if (i >= 0 && i < size) return i;
  return repeat ? ((i % size) + size) % size : std::clamp(i, 0, size - 1);
}

// Four channels at once.
using Channels = Eigen::Array4f;

Channels bilinear(const aircraft::Texture& texture, std::size_t index, float u, float v) {
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
  const auto at = [&](int i, int j) {
    return Eigen::Map<const Channels>(
        level
            .texels[static_cast<std::size_t>(j) * static_cast<std::size_t>(level.width) +
                    static_cast<std::size_t>(i)]
            .data());
  };
  return (1 - fy) * ((1 - fx) * at(x0, y0) + fx * at(x1, y0)) +
         fy * ((1 - fx) * at(x0, y1) + fx * at(x1, y1));
}

}  // namespace

Skin::Skin(const Placed& placed, const Hit& hit, float footprint_m) {
  const aircraft::Mesh& mesh = placed.model->mesh;
  const auto part = static_cast<std::size_t>(hit.part);
  const aircraft::Triangle& triangle = mesh.parts[part].triangles[hit.triangle];
  material_ = &mesh.materials[triangle.material];
  const int index = material_->texture;
  if (index < 0) return;
  texture_ = &mesh.textures[static_cast<std::size_t>(index)];
  for (std::size_t k = 0; k < 3; ++k) uvs_[k] = mesh.uvs[triangle.vertex[k]];
  is_opaque_ = placed.model->opaque[part][hit.triangle] != 0;
  const float texels = footprint_m * placed.model->texels_per_m[part][hit.triangle];
  const float deepest = static_cast<float>(texture_->levels.size() - 1);
  const float level = std::clamp(texels > 1 ? std::log2(texels) : 0.0f, 0.0f, deepest);
  level_ = static_cast<std::size_t>(level);
  coarser_ = level - static_cast<float>(level_);
}

Texel Skin::texel(float u, float v) const {
  if (texture_ == nullptr) return {1, 1, 1, 1};
  const Eigen::Vector2f uv = (1 - u - v) * uvs_[0] + u * uvs_[1] + v * uvs_[2];
  if (!uv.allFinite() || uv.cwiseAbs().maxCoeff() > 1e6f) return {1, 1, 1, 1};
  Texel result;
  Eigen::Map<Channels> channels(result.data());
  channels = bilinear(*texture_, level_, uv.x(), uv.y());
  if (coarser_ > 0)
    channels += coarser_ * (bilinear(*texture_, level_ + 1, uv.x(), uv.y()) - channels);
  return result;
}

Texel Skin::albedo(float u, float v) const {
  Texel result = texel(u, v);
  if (is_opaque_ && result[3] > 0 && result[3] < 1) {
    const float alpha = result[3];
    for (float& channel : result) channel = std::min(1.0f, channel / alpha);
  }
  return result;
}

float opacity_at(const Placed& placed, const Hit& hit, float footprint_m) {
  const aircraft::Mesh& mesh = placed.model->mesh;
  const auto part = static_cast<std::size_t>(hit.part);
  if (placed.model->opaque[part][hit.triangle] != 0) return 1;
  const auto& triangle = mesh.parts[part].triangles[hit.triangle];
  const aircraft::Material& material = mesh.materials[triangle.material];
  const bool textured = material.texture >= 0 &&
                        mesh.textures[static_cast<std::size_t>(material.texture)].has_translucency;
  const float alpha =
      material.opacity * (textured ? Skin(placed, hit, footprint_m).texel(hit.u, hit.v)[3] : 1.0f);
  return alpha >= aircraft::kOpaque ? 1.0f : alpha;
}

namespace {

// A point of the surface in body coordinates, as the shading uses it.
struct Surface {
  // Unit vector towards the viewer's side.
  Eigen::Vector3f face;
  // Unit vector of the smooth surface, on the same side as `face`.
  Eigen::Vector3f normal;
  bool is_back = false;
};

Surface surface_at(const Placed& placed, const Eigen::Vector3f& view, const Hit& hit) {
  const aircraft::Mesh& mesh = placed.model->mesh;
  const auto part = static_cast<std::size_t>(hit.part);
  const auto& [a, b, c] = mesh.parts[part].triangles[hit.triangle].vertex;
  const auto linear = placed.body_from_part[part].linear();
  const std::array<float, 3> weights = {1 - hit.u - hit.v, hit.u, hit.v};
  Surface surface;
  surface.face =
      linear * (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
  surface.face.normalize();
  surface.is_back = surface.face.dot(view) > 0;
  if (surface.is_back) surface.face = -surface.face;
  surface.normal = linear * (weights[0] * mesh.normals[a] + weights[1] * mesh.normals[b] +
                             weights[2] * mesh.normals[c]);
  if (!(surface.normal.norm() > 1e-6f)) surface.normal = surface.face;
  surface.normal.normalize();
  if (surface.normal.dot(surface.face) < 0) surface.normal = -surface.normal;
  return surface;
}

Openness openness_of(const Placed& placed, const Hit& hit, const Surface& surface) {
  const TriangleOpenness& both =
      placed.model->openness[static_cast<std::size_t>(hit.part)][hit.triangle];
  return (surface.is_back ? both.back : both.front).at(hit.u, hit.v);
}

// The cosine between the view and the normal.
float cosine_of(const Surface& surface, const Eigen::Vector3f& view) {
  return std::clamp(-surface.normal.dot(view), 0.0f, 1.0f);
}

const aircraft::Material& material_of(const Placed& placed, const Hit& hit) {
  const aircraft::Mesh& mesh = placed.model->mesh;
  const auto& part = mesh.parts[static_cast<std::size_t>(hit.part)];
  return mesh.materials[part.triangles[hit.triangle].material];
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
                    const Openness& openness,
                    const Eigen::Vector3f& mirror,
                    const Light& light) {
  // From this open share on, nothing counts as hidden.
  constexpr float kNothingHidden = 0.999f;
  const float open = openness.share;
  Around around;
  around.mirrored = light.surroundings->radiance(placed.world_from_body * mirror);
  if (open > kNothingHidden) {
    around.diffuse =
        light.surroundings->irradiance_over_pi(placed.world_from_body * surface.normal);
    return around;
  }
  // The directions about the smooth normal lean in the same way as those about the face's normal.
  const Eigen::Vector3f lean = openness.towards + 2 * open / 3 * (surface.normal - surface.face);
  const Eigen::Vector3f towards = lean.norm() > 1e-6f ? lean.normalized() : surface.normal;
  around.diffuse = light.surroundings->irradiance_over_pi(placed.world_from_body * towards);
  const Rgb own = given_back(placed, openness.given_back, light);
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

// Irradiance over pi on the paint for a sun of 1 that nothing hides.
float sun_on(const Placed& placed, const Surface& surface) {
  const Eigen::Vector3f& to_sun = placed.to_sun_in_body;
  const float cosine = surface.normal.dot(to_sun);
  return cosine > 0 && surface.face.dot(to_sun) > 0 ? cosine : 0;
}

Rgb as_opengl(const aircraft::Material& material,
              const Texel& texel,
              const Around& around,
              const Sunlit& sunlit,
              float sun,
              const Light& light) {
  // Share of painted metal. It replaces the specular colours of the model files, which are chosen
  // for the look of the game.
  constexpr float kGlossShare = 0.08f;
  const float glint = sun * sunlit.glint.strength;
  Rgb rgb;
  for (std::size_t i = 0; i < 3; ++i)
    rgb[i] = material.opacity *
             (material.diffuse[i] * texel[i] * (sun * light.sun[i] + around.diffuse[i]) +
              texel[3] * kGlossShare * material.specular[i] * glint * light.sun[i]);
  return rgb;
}

// A surface that mirrors a share of the light and scatters part of the rest. Premultiplied.
Rgb coated(const aircraft::Material& material,
           const Texel& texel,
           const Around& around,
           const Sunlit& sunlit,
           float sun,
           const Light& light) {
  const Coat coat = coat_of(material, texel);
  const float glint = sun > 0 ? sunlit.glint.strength : 0;
  Rgb rgb;
  for (std::size_t i = 0; i < 3; ++i) {
    const float share = coat.mirrors ? mirror_share(coat.at_normal[i], sunlit.cosine) : 0;
    const float of_sun =
        coat.mirrors ? mirror_share(coat.at_normal[i], sunlit.glint.cosine) * glint : 0;
    rgb[i] = coat.scattered[i] * (1 - share) * (sun * light.sun[i] + around.diffuse[i]) +
             coat.cover * (share * around.mirrored[i] + of_sun * light.sun[i]);
  }
  return rgb;
}

}  // namespace

Around around_at(const Placed& placed,
                 const Eigen::Vector3f& view,
                 const Hit& hit,
                 const Light& light) {
  const Surface surface = surface_at(placed, view, hit);
  if (!light.surroundings) return {hemisphere(placed, surface, light), {}};
  const Eigen::Vector3f mirror =
      (view + 2 * cosine_of(surface, view) * surface.normal).normalized();
  return light_around(placed, surface, openness_of(placed, hit, surface), mirror, light);
}

Sunlit sunlit_at(const Placed& placed,
                 const Eigen::Vector3f& view,
                 const Hit& hit,
                 const Light& light) {
  const Surface surface = surface_at(placed, view, hit);
  Sunlit lit;
  lit.face = surface.face;
  lit.sun = sun_on(placed, surface);
  lit.cosine = cosine_of(surface, view);
  if (!(lit.sun > 0)) return lit;
  const aircraft::Material& material = material_of(placed, hit);
  if (light.surroundings)
    lit.glint = sun_glint(surface.normal, placed.to_sun_in_body, view, roughness_of(material));
  else
    lit.glint.strength = glint_of(surface, placed.to_sun_in_body, view, material.shininess);
  return lit;
}

BodyRay to_sun_from(const Placed& placed,
                    const BodyRay& ray,
                    const Hit& hit,
                    const Sunlit& sunlit) {
  // Height of the start above the surface.
  constexpr float kStartM = 0.01f;
  return {ray.origin + hit.t * ray.direction + kStartM * sunlit.face, placed.to_sun_in_body};
}

Rgb colour_of(const aircraft::Material& material,
              const Texel& texel,
              const Around& around,
              const Sunlit& sunlit,
              bool in_shadow,
              const Light& light) {
  const float sun = in_shadow ? 0 : sunlit.sun;
  return light.surroundings ? coated(material, texel, around, sunlit, sun, light)
                            : as_opengl(material, texel, around, sunlit, sun, light);
}

std::array<float, 3> shade(const Placed& placed,
                           const BodyRay& ray,
                           const Hit& hit,
                           const Light& light,
                           float footprint_m) {
  const Sunlit sunlit = sunlit_at(placed, ray.direction, hit, light);
  bool in_shadow = true;
  if (sunlit.sun > 0) {
    const BodyRay to_sun = to_sun_from(placed, ray, hit, sunlit);
    in_shadow = is_blocked(*placed.model, to_sun.origin, to_sun.direction);
  }
  return colour_of(material_of(placed, hit),
                   Skin(placed, hit, footprint_m).albedo(hit.u, hit.v),
                   around_at(placed, ray.direction, hit, light),
                   sunlit,
                   in_shadow,
                   light);
}

}  // namespace airtruth::render
