// SPDX-License-Identifier: Apache-2.0
#include "labels/projection/exact_box.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "foundation/base/error.h"

namespace airtruth::projection {
namespace {

std::optional<Pixel> pixel_from_cam(const Sight& sight, const Vector3& p_in_cam) {
  const auto nominal = sight.lens->pixel_from_cam(p_in_cam);
  if (!nominal) return std::nullopt;
  // A homography has a horizon, and the image lies on one side of it.
  const auto size = sight.lens->size();
  const double w_of_image =
      (sight.frame_from_nominal.row(2) * Vector3(size.width / 2.0, size.height / 2.0, 1)).value();
  const Vector3 q = sight.frame_from_nominal * Vector3(nominal->x(), nominal->y(), 1);
  if (!(q.z() * w_of_image > 0)) return std::nullopt;
  const Pixel pixel(q.x() / q.z(), q.y() / q.z());
  return pixel.allFinite() ? std::optional(pixel) : std::nullopt;
}

struct Outline {
  BoxBounds bounds;
  bool partly_unseen = false;

  void add(const std::optional<Pixel>& pixel) {
    if (pixel)
      bounds.add(*pixel);
    else
      partly_unseen = true;
  }
};

// The silhouette at one moment.
Outline instant(const Sight& sight,
                const SilhouettePoints& silhouette,
                const Rigid& world_from_body,
                double time_s) {
  Outline outline;
  const Rigid cam_from_body = sight.cam_from_world * world_from_body;
  const Matrix3 rotation = cam_from_body.rotation.toRotationMatrix();
  for (std::size_t part = 0; part < silhouette.points.size(); ++part) {
    const Eigen::Affine3d body_from_part =
        model::body_from_part(silhouette.mesh->parts[part], time_s).cast<double>();
    const Matrix3 cam_from_part = rotation * body_from_part.linear();
    const Vector3 part_in_cam = rotation * body_from_part.translation() + cam_from_body.translation;
    for (const Eigen::Vector3f& point : silhouette.points[part])
      outline.add(pixel_from_cam(sight, cam_from_part * point.cast<double>() + part_in_cam));
  }
  return outline;
}

// The path of one point over the picture during the exposure: a parabola through three projections,
// on which the row time is solved.
class Sweep {
 public:
  Sweep(const Sight& sight, const Twist& body, const Rigid& world_from_body)
      : shutter_(sight.shutter), size_(sight.lens->size()) {
    half_s_ = 0.5 * (shutter_.exposure_s + shutter_.readout_s);
    for (std::size_t k = 0; k < 3; ++k) {
      const double dt_s = (static_cast<double>(k) - 1) * half_s_;
      sights_[k] = sight.at(dt_s);
      cam_from_body_[k] = sights_[k].cam_from_world * carried(world_from_body, body, dt_s);
      rotation_[k] = cam_from_body_[k].rotation.toRotationMatrix();
    }
  }

  // Adds a point that is fixed in the body.
  void add(const Vector3& p_in_body, Outline& outline) const {
    const auto at = places_of(p_in_body);
    if (!at) return outline.add(std::nullopt);
    if (is_within(*at, outline.bounds)) return;
    // Number of steps of the exposure: a choice.
    constexpr int kSteps = 4;
    for (int step = 0; step <= kSteps; ++step) {
      const double into_exposure_s =
          shutter_.exposure_s * (static_cast<double>(step) / kSteps - 0.5);
      outline.add(seen(*at, into_exposure_s));
    }
  }

  // Adds a point that moves in the body: `p_in_body(dt_s)`, at so many moments of the exposure of
  // its own row.
  template <typename Place>
  void add_moving(const Place& p_in_body, int moments, Outline& outline) const {
    const auto pixel_at = [&](double dt_s) -> std::optional<Pixel> {
      const auto at = places_of(p_in_body(dt_s));
      return at ? std::optional(along(*at, dt_s)) : std::nullopt;
    };
    for (int k = 0; k < moments; ++k) {
      const double share = moments > 1 ? static_cast<double>(k) / (moments - 1) - 0.5 : 0;
      const double into_exposure_s = share * shutter_.exposure_s;
      std::optional<Pixel> pixel = pixel_at(into_exposure_s);
      for (int round = 0; shutter_.readout_s > 0 && pixel && round < kRounds; ++round)
        pixel = pixel_at(linear_row_s(*pixel) + into_exposure_s);
      outline.add(pixel);
    }
  }

 private:
  static constexpr int kRounds = 6;

  // The row time of a place, linear from the middle of one row (column) to that of the next, so
  // that a box changes steadily with the place of what turns.
  double linear_row_s(const Pixel& pixel) const {
    const Pixel inside(std::clamp(pixel.x(), 0.0, double(size_.width)),
                       std::clamp(pixel.y(), 0.0, double(size_.height)));
    const bool is_by_row = shutter_.readout == Readout::kDown || shutter_.readout == Readout::kUp;
    const double place = (is_by_row ? inside.y() : inside.x()) - 0.5;
    const auto at = [&](double row) {
      return shutter_.middle_s(Pixel(row, row), size_.width, size_.height);
    };
    const double first = std::floor(place);
    return at(first) + (place - first) * (at(first + 1) - at(first));
  }

  // At the beginning, the middle and the end of the frame's time; empty where one has no pixel.
  std::optional<std::array<Pixel, 3>> places_of(const Vector3& p_in_body) const {
    std::array<Pixel, 3> at;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto pixel =
          pixel_from_cam(sights_[k], rotation_[k] * p_in_body + cam_from_body_[k].translation);
      if (!pixel) return std::nullopt;
      at[k] = *pixel;
    }
    return at;
  }

  // True where the path, at any time of the exposure and of the readout, lies inside the bounds: it
  // does where the control points of its Bezier form do.
  static bool is_within(const std::array<Pixel, 3>& at, const BoxBounds& bounds) {
    // Covers the rounding of control points.
    constexpr double kRoundingPx = 1e-6;
    const Pixel control = 2 * at[1] - 0.5 * (at[0] + at[2]);
    const Pixel low = at[0].cwiseMin(at[2]).cwiseMin(control) - Pixel::Constant(kRoundingPx);
    const Pixel high = at[0].cwiseMax(at[2]).cwiseMax(control) + Pixel::Constant(kRoundingPx);
    const auto box = bounds.box();
    return box && low.x() >= box->x && low.y() >= box->y && high.x() <= box->right() &&
           high.y() <= box->bottom();
  }

  Pixel along(const std::array<Pixel, 3>& at, double dt_s) const {
    // From -1 to 1.
    const double u = half_s_ > 0 ? dt_s / half_s_ : 0;
    return at[1] + 0.5 * u * (at[2] - at[0]) + 0.5 * u * u * (at[2] - 2 * at[1] + at[0]);
  }

  // Row times are treated as linear over the rows: a box is not more accurate than its row.
  Pixel seen(const std::array<Pixel, 3>& at, double into_exposure_s) const {
    const auto pixel_at = [&](double dt_s) { return along(at, into_exposure_s + dt_s); };
    return pixel_at(shutter_.seen_s(pixel_at, size_.width, size_.height, kRounds));
  }

  Shutter shutter_;
  lens::ImageSize size_;
  double half_s_ = 0;
  std::array<Sight, 3> sights_;
  std::array<Rigid, 3> cam_from_body_;
  std::array<Matrix3, 3> rotation_;
};

// A part that spins or swings passes through many angles during the exposure. So many moments are
// taken that neighbours are a few degrees apart.
constexpr double kSpinStepTurns = 1.0 / 120;
constexpr int kMaxSpinSteps = 120;

Outline swept(const Sight& sight,
              const SilhouettePoints& silhouette,
              const Rigid& world_from_body,
              double time_s,
              const Twist& body) {
  Outline outline;
  const Sweep sweep(sight, body, world_from_body);
  for (std::size_t i = 0; i < silhouette.points.size(); ++i) {
    const model::Part& part = silhouette.mesh->parts[i];
    const auto body_from_part = [&](double dt_s) -> Eigen::Affine3d {
      return model::body_from_part(part, time_s + dt_s).cast<double>();
    };
    if (!part.moves()) {
      const Eigen::Affine3d fixed = body_from_part(0);
      for (const Eigen::Vector3f& point : silhouette.points[i])
        sweep.add(fixed * point.cast<double>(), outline);
      continue;
    }
    const double turns = model::fastest_turn_per_s(part) * sight.shutter.exposure_s;
    const int moments =
        1 + std::min(kMaxSpinSteps, static_cast<int>(std::ceil(turns / kSpinStepTurns)));
    for (const Eigen::Vector3f& point : silhouette.points[i])
      sweep.add_moving(
          [&](double dt_s) -> Vector3 { return body_from_part(dt_s) * point.cast<double>(); },
          moments,
          outline);
  }
  return outline;
}

}  // namespace

Sight Sight::at(double dt_s) const {
  Sight moved = *this;
  moved.cam_from_world = carried(cam_from_world.inverse(), camera, dt_s).inverse();
  moved.frame_from_nominal += dt_s * frame_from_nominal_per_s;
  return moved;
}

std::optional<Pixel> pixel_from_world(const Sight& sight, const Vector3& p_in_world) {
  return pixel_from_cam(sight, sight.cam_from_world * p_in_world);
}

ExactBox exact_box(const Sight& sight,
                   const SilhouettePoints& silhouette,
                   const Rigid& world_from_body,
                   double time_s,
                   const Twist& body) {
  check(silhouette.mesh && silhouette.points.size() == silhouette.mesh->parts.size(),
        "a silhouette has the parts of its mesh");
  const Outline outline = sight.shutter.is_instant()
                              ? instant(sight, silhouette, world_from_body, time_s)
                              : swept(sight, silhouette, world_from_body, time_s, body);
  return {outline.bounds.box(), outline.partly_unseen};
}

Bearing bearing_of(const Vector3& in_cam) {
  return {degrees(std::atan2(in_cam.x(), in_cam.z())),
          degrees(std::atan2(-in_cam.y(), std::hypot(in_cam.x(), in_cam.z())))};
}

std::optional<Bearing> seen_bearing(const Sight& sight,
                                    const Vector3& p_in_world,
                                    const Vector3& velocity_in_world_mps) {
  constexpr int kRounds = 8;
  const auto pixel_at = [&](double dt_s) {
    return pixel_from_world(sight.at(dt_s), p_in_world + dt_s * velocity_in_world_mps);
  };
  const lens::ImageSize size = sight.lens->size();
  const double dt_s = sight.shutter.seen_s(pixel_at, size.width, size.height, kRounds);
  const Sight then = dt_s == 0 ? sight : sight.at(dt_s);
  const Vector3 p_then = p_in_world + dt_s * velocity_in_world_mps;
  if (then.frame_from_nominal == Homography::Identity())
    return bearing_of(then.cam_from_world * p_then);
  const auto pixel = pixel_from_world(then, p_then);
  if (!pixel) return std::nullopt;
  const auto ray = sight.lens->ray_from_pixel(*pixel);
  return ray ? std::optional(bearing_of(*ray)) : std::nullopt;
}

}  // namespace airtruth::projection
