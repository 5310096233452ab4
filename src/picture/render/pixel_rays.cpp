// SPDX-License-Identifier: Apache-2.0
#include "picture/render/pixel_rays.h"

namespace airtruth::render {
namespace {

// The coefficients of 1, u and u^2 of the parabola of between() in ray_grid.h.
Thrice<Vector3> coefficients(const Vector3& first, const Vector3& middle, const Vector3& last) {
  return {middle, 0.5 * (last - first), 0.5 * (last - 2 * middle + first)};
}

Vector3 bilinear(const std::array<Vector3, 4>& corner, double x, double y) {
  return (1 - y) * ((1 - x) * corner[0] + x * corner[1]) +
         y * ((1 - x) * corner[2] + x * corner[3]);
}

}  // namespace

Beam beam_of(const TracedIntruder& actor, const RayGrid& grid, int x, int y) {
  Beam beam;
  Thrice<std::array<Vector3, 4>> in_world;
  for (int k = actor.moves ? 0 : 1; k < (actor.moves ? 3 : 2); ++k) {
    in_world[static_cast<std::size_t>(k)] = grid.corners(x, y, k);
    beam.known = beam.known && finite(in_world[static_cast<std::size_t>(k)]);
  }
  if (!beam.known) return beam;
  if (!actor.moves) {
    for (std::size_t c = 0; c < 4; ++c)
      beam.direction_in_body[1][c] = actor.body_from_world * in_world[1][c];
    beam.eye_in_body[1] = actor.eye_in_body;
    return beam;
  }
  const double exposure_s = grid.exposure_s();
  beam.exposes = exposure_s > 0;
  const double middle_s = grid.middle_s(x, y);
  for (std::size_t k = beam.exposes ? 0 : 1; k < (beam.exposes ? 3U : 2U); ++k) {
    const double dt_s = middle_s + 0.5 * (static_cast<double>(k) - 1) * exposure_s;
    const double u = grid.span().u(dt_s);
    const Matrix3 body_from_world = between(actor.body_from_world_at, u);
    beam.eye_in_body[k] = between(actor.eye_in_body_at, u);
    for (std::size_t c = 0; c < 4; ++c) {
      const Thrice<Vector3> corner = {in_world[0][c], in_world[1][c], in_world[2][c]};
      beam.direction_in_body[k][c] = body_from_world * between(corner, u);
    }
  }
  return beam;
}

PixelRays::PixelRays(const TracedIntruder& actor, const RayGrid& grid, int x, int y)
    : samples_(x, y), start_m_(actor.start_m) {
  const Beam beam = beam_of(actor, grid, x, y);
  known_ = beam.known;
  exposes_ = beam.exposes;
  if (!known_) return;
  pixel_rad_ = (beam.direction_in_body[1][1] - beam.direction_in_body[1][0]).norm();
  if (actor.moves) middle_s_ = grid.middle_s(x, y);
  if (!exposes_) {
    direction_[0] = beam.direction_in_body[1];
    eye_[0] = beam.eye_in_body[1];
    return;
  }
  exposure_s_ = grid.exposure_s();
  eye_ = coefficients(beam.eye_in_body[0], beam.eye_in_body[1], beam.eye_in_body[2]);
  for (std::size_t c = 0; c < 4; ++c) {
    const Thrice<Vector3> of_corner = coefficients(
        beam.direction_in_body[0][c], beam.direction_in_body[1][c], beam.direction_in_body[2][c]);
    for (std::size_t k = 0; k < 3; ++k) direction_[k][c] = of_corner[k];
  }
}

BodyRay PixelRays::ray(int sample, double& dt_s) const {
  const auto [x, y] = samples_.at(sample);
  Vector3 direction = bilinear(direction_[0], x, y);
  Vector3 eye = eye_[0];
  dt_s = middle_s_;
  if (exposes_) {
    const double time = samples_.time(sample);
    const double u = 2 * time - 1;
    dt_s += exposure_s_ * (time - 0.5);
    direction += u * (bilinear(direction_[1], x, y) + u * bilinear(direction_[2], x, y));
    eye += u * (eye_[1] + u * eye_[2]);
  }
  direction.normalize();
  return {(eye + start_m_ * direction).cast<float>(), direction.cast<float>()};
}

}  // namespace airtruth::render
