// SPDX-License-Identifier: Apache-2.0
#include "picture/render/reach.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <variant>

namespace airtruth::render {
namespace {

constexpr double kMarginPx = 0.02;
// A side shorter than this many pixels counts as straight under any lens.
constexpr double kStraightPx = 4;

Reach reach_within(const PixelBox& patch, const Pixel& low, const Pixel& high, double margin) {
  const auto bounded = [](double value, int from, int to) {
    return static_cast<int>(std::clamp(value, double(from), double(to)));
  };
  return {bounded(std::floor(low.x() - margin), patch.x, patch.right()),
          bounded(std::floor(low.y() - margin), patch.y, patch.bottom()),
          bounded(std::ceil(high.x() + margin), patch.x, patch.right()),
          bounded(std::ceil(high.y() + margin), patch.y, patch.bottom())};
}

// Bounds of the picture of the part of a triangle in front of a pinhole's plane. Empty where no
// part is, or where a point of it has no pixel.
BoxBounds bounds_before_plane(const Corners& corners, const Eye& eye, bool& all_have_pictures) {
  double size = 0;
  for (const Seen* corner : corners) size = std::max(size, corner->in_world.norm());
  const double near = 1e-7 * size;
  BoxBounds bounds;
  const auto add = [&](const Vector3& point) {
    const auto pixel = eye.pixel(point);
    if (pixel) bounds.add(*pixel);
    all_have_pictures = all_have_pictures && pixel;
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3& from = corners[k]->in_world;
    const Vector3& to = corners[(k + 1) % 3]->in_world;
    const double from_depth = eye.depth(from) - near;
    const double to_depth = eye.depth(to) - near;
    if (from_depth >= 0) add(from);
    if ((from_depth < 0) != (to_depth < 0))
      add(from + from_depth / (from_depth - to_depth) * (to - from));
  }
  return bounds;
}

// Bounds in the frame of an octahedron about the sphere that holds a moving part, at each moment.
std::optional<Box> bounds_of_disc(const aircraft::Mesh& mesh,
                                  const aircraft::Part& part,
                                  const std::vector<Eye>& eyes) {
  const double reach_m = std::sqrt(3.0) * static_cast<double>(aircraft::reach_m(mesh, part));
  BoxBounds bounds;
  for (const Eye& eye : eyes)
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0}) {
        Vector3 in_body = part.centre_in_body.cast<double>();
        in_body[axis] += side * reach_m;
        const auto pixel = eye.pixel(eye.world_from_body * (in_body - eye.eye_in_body));
        if (!pixel) return std::nullopt;
        bounds.add(*pixel);
      }
  return bounds.box();
}

}  // namespace

std::optional<Pixel> Eye::pixel(const Vector3& from_eye_in_world) const {
  const auto nominal = view.lens->pixel_from_cam(cam_from_world * from_eye_in_world);
  if (!nominal) return std::nullopt;
  const Vector3 h = frame_from_nominal * Vector3(nominal->x(), nominal->y(), 1);
  if (!(h.z() > 0)) return std::nullopt;
  return Pixel(h.x() / h.z(), h.y() / h.z());
}

Seen Eye::look_at(const Vector3& from_eye_in_world) const {
  Seen seen{from_eye_in_world, Pixel::Constant(std::numeric_limits<double>::quiet_NaN()), 0};
  const Vector3 in_cam = cam_from_world * from_eye_in_world;
  const auto nominal = view.lens->pixel_from_cam(in_cam);
  if (!nominal) return seen;
  const Vector3 h = frame_from_nominal * Vector3(nominal->x(), nominal->y(), 1);
  if (!(h.z() > 0)) return seen;
  seen.pixel = {h.x() / h.z(), h.y() / h.z()};
  if (in_cam.z() > 0) seen.nearness = 1 / (in_cam.z() * h.z());
  return seen;
}

bool Eye::is_pinhole() const { return std::holds_alternative<lens::Pinhole>(view.lens->model()); }

Reach reach_of(const PixelBox& patch, const Corners& corners, const Eye& eye) {
  const Reach whole{patch.x, patch.y, patch.right(), patch.bottom()};
  Pixel low = corners[0]->pixel;
  Pixel high = low;
  for (const Seen* corner : corners) {
    if (!corner->pixel.allFinite()) {
      if (!eye.is_pinhole()) return whole;
      bool all_have_pictures = true;
      const auto box = bounds_before_plane(corners, eye, all_have_pictures).box();
      if (!all_have_pictures) return whole;
      return box ? reach_within(patch, {box->x, box->y}, {box->right(), box->bottom()}, kMarginPx)
                 : Reach{};
    }
    low = low.cwiseMin(corner->pixel);
    high = high.cwiseMax(corner->pixel);
  }
  double margin = kMarginPx;
  if ((high - low).maxCoeff() > kStraightPx) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Seen& from = *corners[k];
      const Seen& to = *corners[(k + 1) % 3];
      // The middle of the side's picture, which differs from the picture of the side's middle: each
      // point is weighted by its nearness.
      const Vector3 middle = from.in_world.normalized() + to.in_world.normalized();
      const auto pixel = eye.pixel(middle);
      if (!pixel) return whole;
      const Pixel along = to.pixel - from.pixel;
      const Pixel off = *pixel - from.pixel;
      const double length = along.norm();
      const double bend =
          length > 0 ? std::abs(along.x() * off.y() - along.y() * off.x()) / length : 0;
      margin = std::max(margin, 2 * bend + kMarginPx);
    }
  }
  return reach_within(patch, low, high, margin);
}

Reach reach_over_time(const PixelBox& patch,
                      const std::vector<Corners>& corners,
                      const std::vector<Eye>& eyes) {
  Reach all{patch.right(), patch.bottom(), patch.x, patch.y};
  for (std::size_t e = 0; e < eyes.size(); ++e) {
    const Reach r = reach_of(patch, corners[e], eyes[e]);
    if (r.empty()) {
      // The triangle is outside the patch at this moment, but its path may cross the patch.
      for (const Seen* corner : corners[e]) {
        if (!corner->pixel.allFinite()) continue;
        const Reach point = reach_within(patch, corner->pixel, corner->pixel, 1);
        all = {std::min(all.x0, point.x0),
               std::min(all.y0, point.y0),
               std::max(all.x1, point.x1),
               std::max(all.y1, point.y1)};
      }
      continue;
    }
    all = {std::min(all.x0, r.x0),
           std::min(all.y0, r.y0),
           std::max(all.x1, r.x1),
           std::max(all.y1, r.y1)};
  }
  double bulge = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Pixel second = corners[0][k]->pixel - 2 * corners[1][k]->pixel + corners[2][k]->pixel;
    if (second.allFinite()) bulge = std::max(bulge, second.cwiseAbs().maxCoeff() / 8);
  }
  if (all.empty()) return {};
  return wider(all, static_cast<int>(std::ceil(std::min(bulge, 1e4))), patch);
}

Reach reach_of_disc(const PixelBox& patch,
                    const aircraft::Mesh& mesh,
                    const aircraft::Part& part,
                    const std::vector<Eye>& eyes) {
  const auto box = bounds_of_disc(mesh, part, eyes);
  if (!box) return {patch.x, patch.y, patch.right(), patch.bottom()};
  return reach_within(patch, {box->x, box->y}, {box->right(), box->bottom()}, 1);
}

std::vector<Eye> eyes_of(const TracedIntruder& actor, const View& view, const RayGrid& grid) {
  std::vector<Eye> eyes;
  for (int k = actor.moves ? 0 : 1; k < (actor.moves ? 3 : 2); ++k) {
    const View then = view.at(grid.span().at(k));
    const auto i = static_cast<std::size_t>(k);
    eyes.push_back({then,
                    actor.body_from_world_at[i].transpose(),
                    actor.eye_in_body_at[i],
                    then.nominal_from_frame.inverse(),
                    then.world_from_cam.rotation.conjugate()});
  }
  return eyes;
}

std::optional<int> swing_margin_px(const aircraft::Mesh& mesh,
                                   const aircraft::Part& part,
                                   const std::vector<Eye>& eyes,
                                   double span_s) {
  if (part.spins) return std::nullopt;
  // A function is within (T / 2)^3 / (9 sqrt 3) of its largest third derivative from the parabola
  // through its values at the beginning, the middle and the end of a time T. The place of a point
  // at distance r from a hinge whose angle is a wave of the rate s and turns at w at most has a
  // third derivative of at most r (w^3 + 3 w^2 s + w s^2).
  constexpr double kMostShare = 0.05;
  const double turn = 2 * kPi * aircraft::fastest_turn_per_s(part);
  const double wave = 2 * kPi * std::abs(part.beat.strokes_per_s);
  const double share = std::pow((turn + wave) * span_s / 2, 3) / (9 * std::sqrt(3.0));
  const auto box = bounds_of_disc(mesh, part, eyes);
  if (!box || share > kMostShare) return std::nullopt;
  return static_cast<int>(std::ceil(share * std::max(box->width, box->height) / 2));
}

Reach wider(const Reach& reach, int more, const PixelBox& patch) {
  return {std::max(reach.x0 - more, patch.x),
          std::max(reach.y0 - more, patch.y),
          std::min(reach.x1 + more, patch.right()),
          std::min(reach.y1 + more, patch.bottom())};
}

std::vector<std::uint32_t> largest_first(const std::vector<Reach>& reaches) {
  constexpr std::size_t kSizes = 65;
  const auto size = [](const Reach& reach) {
    return kSizes - 1 - static_cast<std::size_t>(std::bit_width(reach.pixels()));
  };
  std::array<std::uint32_t, kSizes + 1> first{};
  for (const Reach& reach : reaches) ++first[size(reach) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> order(reaches.size());
  for (std::size_t i = 0; i < reaches.size(); ++i)
    order[first[size(reaches[i])]++] = static_cast<std::uint32_t>(i);
  return order;
}

}  // namespace airtruth::render
