// SPDX-License-Identifier: Apache-2.0
#include "picture/render/shade_pixel.h"

#include <algorithm>
#include <cmath>

#include "picture/render/skin.h"
#include "picture/render/trace.h"

namespace airtruth::render {
namespace {

// The barycentric weights of the second and the third corner. A place that is the mean of several
// may lie a little outside the triangle.
std::array<float, 2> weights_of(const Eigen::Array4f& functions) {
  const Eigen::Array4f inside = functions.max(0.0f);
  const float sum = inside[0] + inside[1] + inside[2];
  return sum > 0 ? std::array<float, 2>{inside[1] / sum, inside[2] / sum}
                 : std::array<float, 2>{1.0f / 3, 1.0f / 3};
}

}  // namespace

PixelShading::Lit PixelShading::lit_at(const Visibility& seen,
                                       const VisibleSurface& visible,
                                       int x,
                                       int y) const {
  const RayTriangle& triangle = triangles_.all()[visible.triangle];
  const PixelPlace& at = visible.middle;
  const Eigen::Array4f functions = seen.functions(visible.candidate)(at.x, at.y, at.t);
  const auto [u, v] = weights_of(functions);
  Lit lit;
  lit.visible = &visible;
  lit.placed = &instances_[triangle.instance];
  const Placed& placed = lit.placed->placed;
  lit.hit = {0, static_cast<int>(triangle.part), triangle.in_part, u, v};
  lit.distance_m = 1 / std::clamp(functions[3], triangle.farthest, triangle.nearest);
  const Facet& facet = placed.facet(lit.hit);
  const Eigen::Affine3f& body_from_part = placed.body_from_part[triangle.pose];
  lit.in_body = body_from_part * Eigen::Vector3f((1 - u - v) * facet.corner[0] +
                                                 u * facet.corner[1] + v * facet.corner[2]);
  const double span_u = rays_.span().u(
      rays_.middle_s(x, y) + 0.5 * rays_.exposure_s() * static_cast<double>(visible.middle.t));
  const Thrice<Vector3>& eye = lit.placed->eye_in_body;
  const Vector3 from_eye =
      lit.in_body.cast<double>() - (eye[0] + span_u * (eye[1] + span_u * eye[2]));
  lit.surface = surface_at(placed, body_from_part, from_eye.normalized().cast<float>(), lit.hit);
  lit.sunlit = sunlit_at(placed, lit.surface, placed.material(facet));
  lit.in_shadow = true;
  return lit;
}

// Surfaces that face away from the sun are in shadow without a ray.
void PixelShading::find_shadows() {
  for (std::size_t first = 0; first < lit_.size();) {
    // Of one model at a time.
    const Model::Impl* model = lit_[first].placed->placed.model;
    to_sun_.clear();
    of_ray_.clear();
    std::size_t i = first;
    for (; i < lit_.size() && lit_[i].placed->placed.model == model; ++i) {
      const Lit& lit = lit_[i];
      if (!(lit.sunlit.sun > 0)) continue;
      of_ray_.push_back(static_cast<std::uint32_t>(i));
      to_sun_.push_back(to_sun_from(lit.placed->placed, lit.in_body, lit.surface));
    }
    blocked_.resize(to_sun_.size());
    find_blocked(*model, to_sun_, blocked_);
    for (std::size_t k = 0; k < of_ray_.size(); ++k) lit_[of_ray_[k]].in_shadow = blocked_[k] != 0;
    first = i;
  }
}

Texel PixelShading::albedo_of(const Visibility& seen, const Lit& lit) const {
  const Placed& placed = lit.placed->placed;
  const Facet& facet = placed.facet(lit.hit);
  if (placed.material(facet).texture < 0) return {1, 1, 1, 1};
  const VisibleSurface& visible = *lit.visible;
  const std::size_t reads = visible.end_read - visible.first_read;
  const float share = visible.light / static_cast<float>(reads);
  const Skin skin(
      placed.model->mesh, facet, lit.distance_m * seen.ray().pixel_rad() * std::sqrt(share));
  Eigen::Array4f sum = Eigen::Array4f::Zero();
  for (std::uint32_t i = visible.first_read; i < visible.end_read; ++i) {
    const PixelPlace& at = seen.reads()[i];
    const auto [u, v] = weights_of(seen.functions(visible.candidate)(at.x, at.y, at.t));
    const Texel texel = skin.albedo(u, v);
    sum += Eigen::Map<const Eigen::Array4f>(texel.data());
  }
  Texel mean;
  Eigen::Map<Eigen::Array4f>{mean.data()} = sum / static_cast<float>(reads);
  return mean;
}

PixelLight PixelShading::light_of(const Visibility& seen, int x, int y) {
  lit_.clear();
  for (const VisibleSurface& visible : seen.surfaces())
    lit_.push_back(lit_at(seen, visible, x, y));
  find_shadows();
  PixelLight sum;
  for (const Lit& lit : lit_) {
    const Placed& placed = lit.placed->placed;
    const Rgb rgb = colour_of(placed.material(placed.facet(lit.hit)),
                              albedo_of(seen, lit),
                              around_at(placed, lit.surface, lit.hit, light_),
                              lit.sunlit,
                              lit.surface.cosine,
                              lit.in_shadow,
                              light_);
    const double light = static_cast<double>(lit.visible->light);
    for (std::size_t c = 0; c < 3; ++c) sum.rgb[c] += light * static_cast<double>(rgb[c]);
    sum.distance_m +=
        static_cast<double>(lit.visible->weight) * static_cast<double>(lit.distance_m);
  }
  return sum;
}

}  // namespace airtruth::render
