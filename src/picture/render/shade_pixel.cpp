// SPDX-License-Identifier: Apache-2.0
#include "picture/render/shade_pixel.h"

#include <algorithm>
#include <cmath>

#include "picture/shade/texture.h"
#include "picture/shade/trace.h"

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

PixelShading::Lit PixelShading::lit_at(const Visibility& visibility,
                                       const VisibleSurface& visible,
                                       int x,
                                       int y) const {
  const RayTriangle& triangle = triangles_.all()[visible.triangle];
  const PixelPlace& at = visible.middle;
  const Eigen::Array4f functions = visibility.functions(visible.candidate)(at.x, at.y, at.t);
  const std::array<float, 2> weights = weights_of(functions);
  const auto [u, v] = weights;
  Lit lit;
  lit.visible = &visible;
  lit.placed = &instances_[triangle.instance];
  const shade::Placed& placed = lit.placed->placed;
  lit.hit = {0, static_cast<int>(triangle.part), triangle.in_part, u, v};
  lit.distance_m = 1 / std::clamp(functions[3], triangle.farthest, triangle.nearest);
  const shade::Facet& facet = placed.facet(lit.hit);
  const Eigen::Affine3f& body_from_part = placed.body_from_part[triangle.pose];
  const double span_u = rays_.span().u(
      rays_.middle_s(x, y) + 0.5 * rays_.exposure_s() * static_cast<double>(visible.middle.t));
  const Thrice<Vector3>& eye = lit.placed->eye_in_body;
  const Vector3 from_eye =
      in_body(visible, weights).cast<double>() - (eye[0] + span_u * (eye[1] + span_u * eye[2]));
  lit.surface =
      shade::surface_at(placed, body_from_part, from_eye.normalized().cast<float>(), lit.hit);
  lit.sunlit = shade::sunlit_at(placed, lit.surface, placed.material(facet));
  return lit;
}

std::array<float, 2> PixelShading::weights_at(const Visibility& visibility,
                                              const VisibleSurface& visible,
                                              const PixelPlace& at) const {
  return weights_of(visibility.functions(visible.candidate)(at.x, at.y, at.t));
}

Eigen::Vector3f PixelShading::in_body(const VisibleSurface& visible,
                                      const std::array<float, 2>& weights) const {
  const RayTriangle& triangle = triangles_.all()[visible.triangle];
  const shade::Placed& placed = instances_[triangle.instance].placed;
  const auto& corner = placed.model->facets[triangle.part][triangle.in_part].corner;
  const auto [u, v] = weights;
  return placed.body_from_part[triangle.pose] *
         Eigen::Vector3f((1 - u - v) * corner[0] + u * corner[1] + v * corner[2]);
}

// Surfaces that face away from the sun are in shadow without a ray.
void PixelShading::find_shadows(const Visibility& visibility) {
  // A ray to the sun for each fourth place at which textures are read: a packet for a pixel.
  constexpr std::uint32_t kReadsOfRay = 4;
  for (std::size_t first = 0; first < lit_.size();) {
    // Of one model at a time.
    const shade::Model::Impl* model = lit_[first].placed->placed.model;
    to_sun_.clear();
    of_ray_.clear();
    std::size_t i = first;
    for (; i < lit_.size() && lit_[i].placed->placed.model == model; ++i) {
      const Lit& lit = lit_[i];
      if (!(lit.sunlit.sun > 0)) continue;
      const VisibleSurface& visible = *lit.visible;
      for (std::uint32_t r = visible.first_read; r < visible.end_read; r += kReadsOfRay) {
        const auto weights = weights_at(visibility, visible, visibility.reads()[r]);
        of_ray_.push_back(static_cast<std::uint32_t>(i));
        to_sun_.push_back(
            shade::to_sun_from(lit.placed->placed, in_body(visible, weights), lit.surface));
      }
    }
    blocked_.resize(to_sun_.size());
    shade::find_blocked(*model, to_sun_, blocked_);
    for (std::size_t k = 0; k < of_ray_.size(); ++k) {
      Lit& lit = lit_[of_ray_[k]];
      lit.sun_rays += 1;
      lit.open_sun_rays += blocked_[k] != 0 ? 0.0f : 1.0f;
    }
    first = i;
  }
}

shade::Texel PixelShading::albedo_of(const Visibility& visibility, const Lit& lit) const {
  const shade::Placed& placed = lit.placed->placed;
  const shade::Facet& facet = placed.facet(lit.hit);
  if (placed.material(facet).texture < 0) return {1, 1, 1, 1};
  const VisibleSurface& visible = *lit.visible;
  const std::size_t reads = visible.end_read - visible.first_read;
  const float share = visible.light / static_cast<float>(reads);
  const shade::TriangleTexture texture(
      placed.model->mesh, facet, lit.distance_m * visibility.ray().pixel_rad() * std::sqrt(share));
  Eigen::Array4f sum = Eigen::Array4f::Zero();
  for (std::uint32_t i = visible.first_read; i < visible.end_read; ++i) {
    const PixelPlace& at = visibility.reads()[i];
    const auto [u, v] = weights_at(visibility, visible, at);
    const shade::Texel texel = texture.albedo(u, v);
    sum += Eigen::Map<const Eigen::Array4f>(texel.data());
  }
  shade::Texel mean;
  Eigen::Map<Eigen::Array4f>{mean.data()} = sum / static_cast<float>(reads);
  return mean;
}

PixelLight PixelShading::light_of(const Visibility& visibility, int x, int y) {
  lit_.clear();
  for (const VisibleSurface& visible : visibility.surfaces())
    lit_.push_back(lit_at(visibility, visible, x, y));
  find_shadows(visibility);
  PixelLight sum;
  for (const Lit& lit : lit_) {
    const shade::Placed& placed = lit.placed->placed;
    const image::Rgb rgb = shade::colour_of(placed.material(placed.facet(lit.hit)),
                                            albedo_of(visibility, lit),
                                            shade::around_at(placed, lit.surface, lit.hit, light_),
                                            lit.sunlit,
                                            lit.surface.cosine,
                                            lit.sun_rays > 0 ? lit.open_sun_rays / lit.sun_rays : 0,
                                            light_);
    const double light = static_cast<double>(lit.visible->light);
    for (std::size_t c = 0; c < 3; ++c) sum.rgb[c] += light * static_cast<double>(rgb[c]);
    sum.distance_m +=
        static_cast<double>(lit.visible->weight) * static_cast<double>(lit.distance_m);
  }
  return sum;
}

}  // namespace airtruth::render
