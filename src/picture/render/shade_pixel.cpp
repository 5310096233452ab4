// SPDX-License-Identifier: Apache-2.0
#include "picture/render/shade_pixel.h"

#include <algorithm>
#include <cmath>

#include "picture/shade/trace.h"

namespace airtruth::render {
namespace {

// Of a pixel's reads every fourth is shaded, and one of each surface; then all, unless the mean is
// known.
constexpr std::array<std::uint32_t, 2> kStrides{4, 1};

// The barycentric weights of the second and the third corner. A place that is the mean of several
// may lie a little outside the triangle.
std::array<float, 2> weights_of(const Eigen::Array4f& functions) {
  const Eigen::Array4f inside = functions.max(0.0f);
  const float sum = inside[0] + inside[1] + inside[2];
  return sum > 0 ? std::array<float, 2>{inside[1] / sum, inside[2] / sum}
                 : std::array<float, 2>{1.0f / 3, 1.0f / 3};
}

}  // namespace

PixelShading::Point PixelShading::point_at(const Visibility& visibility,
                                           const VisibleSurface& visible,
                                           const PixelPlace& at) const {
  const RayTriangle& triangle = visibility.triangle(visible.candidate);
  const PlacedInstance& instance = instances_[triangle.instance];
  const Eigen::Array4f functions = visibility.functions(visible.candidate)(at.x, at.y, at.t);
  const auto [u, v] = weights_of(functions);
  Point point;
  point.placed = &instance.placed;
  point.hit = {0, static_cast<int>(triangle.part), triangle.in_part, u, v};
  point.distance_m = 1 / std::clamp(functions[3], triangle.farthest, triangle.nearest);
  const Eigen::Affine3f& body_from_part = point.placed->body_from_part[triangle.pose];
  const auto& corner = point.placed->facet(point.hit).corner;
  point.in_body =
      body_from_part * Eigen::Vector3f((1 - u - v) * corner[0] + u * corner[1] + v * corner[2]);
  const double span_u = u_ + half_u_ * static_cast<double>(at.t);
  const Thrice<Vector3>& eye = instance.eye_in_body;
  const Vector3 eye_in_body = eye[0] + span_u * (eye[1] + span_u * eye[2]);
  const Eigen::Vector3f view = (point.in_body - eye_in_body.cast<float>()).normalized();
  point.surface = shade::surface_at(*point.placed, body_from_part, view, point.hit);
  return point;
}

bool PixelShading::Colours::mean_is_known() const {
  // Standard error of a mean colour, as a share of it: below one code value of a video in the
  // middle of its range.
  constexpr float kTolerance = 0.01f;
  // Linear light, of which 1 is white, below which the tolerance stays the same.
  constexpr float kNearBlack = 0.03f;
  if (count < 4) return false;
  const Eigen::Array3f mean = sum / count;
  const Eigen::Array3f variance = (squares - sum * mean) / (count - 1);
  const Eigen::Array3f allowed = kTolerance * (mean + kNearBlack);
  return (variance <= count * allowed * allowed).all();
}

void PixelShading::Colours::add(const Eigen::Array3f& colour) {
  count += 1;
  sum += colour;
  squares += colour * colour;
}

PixelShading::Shaded PixelShading::shaded(const Visibility& visibility,
                                          const VisibleSurface& visible) const {
  const Point middle = point_at(visibility, visible, visible.middle);
  const shade::Placed& placed = *middle.placed;
  const auto reads = static_cast<float>(visible.end_read - visible.first_read);
  return {&visible,
          middle.distance_m,
          shade::around_at(placed, middle.surface, middle.hit, light_),
          {placed.model->mesh,
           placed.facet(middle.hit),
           middle.distance_m * visibility.ray().pixel_rad() * std::sqrt(visible.light / reads)}};
}

void PixelShading::add_points(const Visibility& visibility, std::uint32_t stride) {
  for (std::uint32_t k = 0; k < shaded_.size(); ++k) {
    const VisibleSurface& visible = *shaded_[k].visible;
    const std::uint32_t middle = (visible.first_read + visible.end_read) / 2;
    for (std::uint32_t i = visible.first_read; i < visible.end_read; ++i) {
      if (is_shaded_[i] != 0 || (i % stride != stride / 2 && i != middle)) continue;
      is_shaded_[i] = 1;
      points_.push_back(point_at(visibility, visible, visibility.reads()[i]));
      points_.back().of = k;
    }
  }
}

// Points that face away from the sun are in shadow without a ray.
void PixelShading::find_sunlight() {
  for (std::size_t first = 0; first < points_.size();) {
    // Of one model at a time.
    const shade::Model::Impl* model = points_[first].placed->model;
    to_sun_.clear();
    of_ray_.clear();
    std::size_t i = first;
    for (; i < points_.size() && points_[i].placed->model == model; ++i) {
      Point& point = points_[i];
      const shade::Placed& placed = *point.placed;
      point.sunlit =
          shade::sunlit_at(placed, point.surface, placed.material(placed.facet(point.hit)));
      if (!(point.sunlit.sun > 0)) continue;
      of_ray_.push_back(static_cast<std::uint32_t>(i));
      to_sun_.push_back(shade::to_sun_from(placed, point.in_body, point.surface));
    }
    blocked_.resize(to_sun_.size());
    shade::find_blocked(*model, to_sun_, blocked_);
    for (std::size_t k = 0; k < of_ray_.size(); ++k)
      points_[of_ray_[k]].in_shadow = blocked_[k] != 0;
    first = i;
  }
}

void PixelShading::shade_points() {
  find_sunlight();
  for (const Point& point : points_) {
    Shaded& surface = shaded_[point.of];
    const image::Rgb rgb = shade::colour_of({point.placed->material(point.placed->facet(point.hit)),
                                             surface.texture.albedo(point.hit.u, point.hit.v),
                                             surface.around,
                                             point.sunlit,
                                             point.surface.cosine,
                                             point.in_shadow},
                                            light_);
    const Eigen::Map<const Eigen::Array3f> colour(rgb.data());
    surface.count += 1;
    surface.sum += colour;
    colours_.add(colour);
  }
  points_.clear();
}

PixelLight PixelShading::light_of(const Visibility& visibility, int x, int y) {
  u_ = rays_.span().u(rays_.middle_s(x, y));
  half_u_ = rays_.span().u(rays_.middle_s(x, y) + 0.5 * rays_.exposure_s()) - u_;
  shaded_.clear();
  for (const VisibleSurface& visible : visibility.surfaces())
    shaded_.push_back(shaded(visibility, visible));
  is_shaded_.assign(visibility.reads().size(), 0);
  colours_ = {};
  for (const std::uint32_t stride : kStrides) {
    add_points(visibility, stride);
    shade_points();
    if (colours_.mean_is_known()) break;
  }
  PixelLight sum;
  for (const Shaded& surface : shaded_) {
    const VisibleSurface& visible = *surface.visible;
    for (int c = 0; c < 3; ++c)
      sum.rgb[static_cast<std::size_t>(c)] +=
          static_cast<double>(visible.light * surface.sum[c] / surface.count);
    sum.distance_m += static_cast<double>(visible.weight) * static_cast<double>(surface.distance_m);
  }
  return sum;
}

}  // namespace airtruth::render
