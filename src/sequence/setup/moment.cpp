// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/moment.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/seed.h"
#include "sequence/setup/world.h"

namespace airtruth::setup {
namespace {

Rigid world_from_shaken_cam(const trajectory::State& camera, const Shake& shake, double dt_s) {
  Rigid world_from_cam =
      camera.world_from_body_rigid() * Rigid{cam_from_body().conjugate(), Vector3::Zero()};
  if (shake.rotation)
    world_from_cam.rotation =
        (world_from_cam.rotation * shake.rotation_at(dt_s).conjugate()).normalized();
  return world_from_cam;
}

// Angular rate along a path in world axes, from one-sided differences where the path begins or
// ends. rotation(state, dt_s) gives the rotation.
template <typename Rotation>
Vector3 turning(const trajectory::Path& path, double time_s, const Rotation& rotation) {
  constexpr double kStep_s = 1e-3;  // of the difference: chosen
  const double before_s = path.at(time_s - kStep_s) ? -kStep_s : 0;
  const double after_s = path.at(time_s + kStep_s) ? kStep_s : 0;
  if (!(after_s > before_s)) return Vector3::Zero();
  const auto before = path.at(time_s + before_s);
  const auto after = path.at(time_s + after_s);
  return vector_from_rotation(rotation(*after, after_s) * rotation(*before, before_s).conjugate()) /
         (after_s - before_s);
}

// How far beyond an aircraft's exact box its pixels are searched, px: those that the box touches in
// part, and half a pixel to spare.
constexpr double kSearchMarginPx = 1.5;

// For an aircraft so near that a part of it has no pixel: the rest may lie anywhere, also beyond
// the frame, which cuts it.
Box everywhere(const lens::ImageSize& size) {
  constexpr double kFarPx = 1e6;  // pixels_of() goes no farther
  return wider(Box{0, 0, double(size.width), double(size.height)}, kFarPx);
}

// The directions of a cone, in cam.
struct Cone {
  Vector3 axis = Vector3::UnitZ();
  double half_angle_rad = kPi;
};

// The cone that holds an aircraft throughout the frame's exposure and readout.
Cone cone_of(const Actor& actor,
             const trajectory::State& state,
             const Twist& twist,
             const projection::Sight& sight) {
  const model::Mesh& mesh = *actor.type->silhouette.mesh;
  double radius_m = 0;
  for (const model::Part& part : mesh.parts)
    radius_m = std::max<double>(radius_m, part.centre_in_body.norm() + reach_m(mesh, part));
  const double half_s = 0.5 * (sight.shutter.exposure_s + sight.shutter.readout_s);
  radius_m += half_s * (twist.velocity_mps - sight.camera.velocity_mps).norm();
  const Vector3 p_in_cam = sight.cam_from_world * state.position_in_world;
  const double distance_m = p_in_cam.norm();
  if (!(distance_m > radius_m)) return {};
  return {p_in_cam / distance_m,
          std::asin(radius_m / distance_m) + half_s * sight.camera.rate_radps.norm()};
}

// A direction, or beyond the lens's field the one at its end on the same side of the axis.
Vector3 within_field(const Vector3& direction, const lens::Lens& lens) {
  const double end_rad = lens.max_angle_rad() * (1 - 1e-9);  // within it by more than a rounding
  const Pixel aside = direction.head<2>();
  if (std::atan2(aside.norm(), direction.z()) <= end_rad || aside.isZero(0)) return direction;
  const Pixel side = std::sin(end_rad) * aside.normalized();
  return {side.x(), side.y(), std::cos(end_rad)};
}

// Bounds of the pixels whose rays lie in a cone: those of its rim and of the end of the field
// within it, and a margin for what lies between the directions that are looked at. Empty where the
// cone comes near the direction opposite to the lens's axis, about which its rim turns too fast.
std::optional<Box> box_of(const Cone& cone, const lens::Lens& lens) {
  constexpr double kFarthestOffAxisRad = 5 * kPi / 6;
  if (!(std::acos(cone.axis.z()) + cone.half_angle_rad < kFarthestOffAxisRad)) return std::nullopt;
  constexpr int kDirections = 128;
  constexpr double kMarginShare = 0.05;  // of the longer side; the directions are that far apart
  const Vector3 across = cone.axis.unitOrthogonal(), along = cone.axis.cross(across);
  BoxBounds bounds;
  for (int i = 0; i < kDirections; ++i) {
    const double turn_rad = 2 * kPi * i / kDirections;
    const Vector3 rim =
        std::cos(cone.half_angle_rad) * cone.axis +
        std::sin(cone.half_angle_rad) * (std::cos(turn_rad) * across + std::sin(turn_rad) * along);
    if (const auto pixel = lens.pixel_from_cam(within_field(rim, lens))) bounds.add(*pixel);
  }
  const auto box = bounds.box();
  if (!box) return box;
  return wider(*box, kSearchMarginPx + kMarginShare * std::max(box->width, box->height));
}

// The exact box is that of the silhouette's points. Through a lens that is no pinhole the straight
// edges between them bulge: an arc over the angle a departs from its chord by a / 8 of it.
double bulge_px(const Box& box, const lens::Lens& lens) {
  if (std::holds_alternative<lens::Pinhole>(lens.model())) return 0;
  const double side_px = std::hypot(box.width, box.height);
  return side_px * side_px / (8 * lens.focal_px());
}

// Of an aircraft that has a part without a pixel: across the end of a lens's field, or beside and
// behind a pinhole.
Box box_of_partly_unseen(const Box& seen,
                         const Actor& actor,
                         const trajectory::State& state,
                         const Twist& twist,
                         const projection::Sight& sight) {
  const lens::Lens& lens = *sight.lens;
  if (std::holds_alternative<lens::Pinhole>(lens.model()) ||
      !sight.frame_from_nominal.isIdentity(0))
    return everywhere(lens.size());
  const auto box = box_of(cone_of(actor, state, twist, sight), lens);
  return box ? bounds(*box, seen) : everywhere(lens.size());
}

std::optional<Box> search_box(const projection::ExactBox& exact,
                              const Actor& actor,
                              const std::optional<trajectory::State>& state,
                              const Twist& twist,
                              const projection::Sight& sight) {
  if (!state || !exact.box) return std::nullopt;
  const lens::Lens& lens = *sight.lens;
  const Box box = exact.partly_unseen
                      ? box_of_partly_unseen(*exact.box, actor, *state, twist, sight)
                      : wider(*exact.box, kSearchMarginPx + bulge_px(*exact.box, lens));
  if (!meets_frame(box, lens.size())) return std::nullopt;
  return box;
}

}  // namespace

projection::Sight sight_of(const lens::Lens& lens,
                           const Shutter& shutter,
                           const trajectory::Path& path,
                           const trajectory::State& camera,
                           double time_s,
                           const Shake& shake) {
  const Rigid world_from_cam = world_from_shaken_cam(camera, shake, 0);
  projection::Sight sight{&lens, world_from_cam.inverse(), shake.frame_from_reference};
  if (shutter.is_instant()) return sight;
  sight.shutter = shutter;
  sight.frame_from_nominal_per_s = shake.frame_from_reference_per_s;
  sight.camera = {camera.velocity_in_world_mps,
                  turning(path, time_s, [&](const trajectory::State& state, double dt_s) {
                    return world_from_shaken_cam(state, shake, dt_s).rotation;
                  })};
  return sight;
}

Twist twist_of(const trajectory::Path& path,
               const trajectory::State& state,
               double time_s,
               const Shutter& shutter) {
  if (shutter.is_instant()) return {};
  return {state.velocity_in_world_mps,
          turning(path, time_s, [](const trajectory::State& then, double) {
            return then.world_from_body;
          })};
}

bool meets_frame(const Box& box, const lens::ImageSize& size) {
  return box.right() > 0 && box.bottom() > 0 && box.x < size.width && box.y < size.height;
}

std::optional<PixelBox> search_bounds(const Moment& moment) {
  std::optional<PixelBox> all;
  for (const auto& box : moment.search)
    if (box) all = all ? bounds(*all, pixels_of(*box)) : pixels_of(*box);
  return all;
}

namespace {

// Standard deviation of the amplitude of a dirt's first lobe; the k-th has a k-th of it. All lobes
// together stay far below 1, so that the outline never meets the centre.
constexpr double kLobeShare = 0.10;
constexpr double kMostLobe = 0.15;

// Wings of an insect as shares of its body's length, about those of a honeybee worker: a body of 13
// mm, a thorax of 4 mm, a forewing of 9.7 mm with a mean chord of 3 mm. A bee beats them 230 times
// a second through 90 degrees (Altshuler et al. 2005, PNAS 102, 18213): from exposures of 1/230 s
// on the whole stroke is one blur.
constexpr double kWingLength = (9.7 + 4.0 / 2) / 13;  // from the middle of the body to a tip
constexpr double kWingRadius = 0.5 * 9.7 * 0.7 / 13;  // half of the stroke's height: chosen
// Half way out the chord of 3 mm sweeps an arc of 7.6 mm, and half of the light goes through the
// wing: chosen.
constexpr double kWingShare = 3 / 7.6 * 0.5;

// Distance at which a point stands for the sun's direction: parallax is below 1e-6 of a pixel.
constexpr double kSunM = 1e12;

// A point on the line from the picture of the lens's axis to the sun. Reflections between the
// surfaces of a lens lie on it, whatever the lens (Hullin et al. 2011, "Physically-based real-time
// lens flare rendering", section 3).
std::optional<Pixel> glint_pixel(const scene::LensMark& mark,
                                 const projection::Sight& sight,
                                 const Vector3& to_sun_in_world) {
  const Rigid world_from_cam = sight.cam_from_world.inverse();
  const auto sun =
      projection::pixel_from_world(sight, world_from_cam.translation + kSunM * to_sun_in_world);
  const auto axis = projection::pixel_from_world(sight, world_from_cam * Vector3(0, 0, kSunM));
  if (!sun || !axis) return std::nullopt;
  return Pixel(*axis + mark.along * (*sun - *axis));
}

void add_lobes(image::Spot& spot, Random random) {
  for (std::size_t k = 0; k < image::Spot::kLobes; ++k) {
    const double share = kLobeShare / static_cast<double>(k + 1);
    for (double* lobe : {&spot.cosines[k], &spot.sines[k]})
      *lobe = std::clamp(share * random.normal(), -kMostLobe, kMostLobe);
  }
}

// A number of the whole pixel at which a mark begins, so that marks of one name and of several
// scenes have shapes of their own.
std::uint64_t place_of(const scene::LensMark& mark) {
  const Pixel at = mark.pixel.value_or(Pixel::Zero());
  const auto whole = [](double x) { return static_cast<std::uint64_t>(std::llround(x)); };
  return (whole(at.x()) << 32) ^ (whole(at.y()) & 0xffffffffU);
}

}  // namespace

bool is_there(const scene::LensMark& mark, double time_s) {
  return time_s >= mark.begin_s && (!mark.end_s || time_s <= *mark.end_s);
}

std::optional<image::Spot> spot_of(const scene::LensMark& mark,
                                   const projection::Sight& sight,
                                   const Vector3& to_sun_in_world,
                                   double time_s,
                                   std::uint64_t seed) {
  if (!is_there(mark, time_s)) return std::nullopt;
  image::Spot spot;
  if (mark.pixel) {
    spot.velocity_px_s = mark.velocity_px_s;
    spot.centre = *mark.pixel + (time_s - mark.begin_s) * mark.velocity_px_s;
  } else {
    const auto pixel = glint_pixel(mark, sight, to_sun_in_world);
    if (!pixel) return std::nullopt;
    spot.centre = *pixel;
  }
  spot.radius_px = mark.size_px / 2;
  spot.half_length_px = (mark.length_px - mark.size_px) / 2;
  if (mark.velocity_px_s.norm() > 0) spot.direction = mark.velocity_px_s.normalized();
  spot.softness = mark.softness;
  spot.opacity = mark.opacity;
  for (std::size_t c = 0; c < 3; ++c) spot.colour[c] = static_cast<float>(mark.colour[c]);
  if (mark.kind == scene::DistractorKind::kInsect) {
    spot.wing_radius_px = kWingRadius * mark.length_px;
    spot.wing_px = kWingLength * mark.length_px - spot.wing_radius_px;
    spot.wing_share = kWingShare;
  }
  if (mark.kind == scene::DistractorKind::kDirt)
    add_lobes(spot, Seed(seed).stream("outline of " + mark.id, place_of(mark)));
  return spot;
}

Moment moment_at(const World& world, std::int64_t frame, double time_s, const Shake& shake) {
  const auto camera = world.camera.at(time_s);
  if (!camera)
    throw Error(fmt::format("the camera's path ends at {:.6g} s, but the clip goes on at {:.6g} s; "
                            "expected a path as long as the clip",
                            world.camera.end_s(),
                            time_s),
                world.camera_where);
  Moment moment;
  moment.frame = frame;
  moment.time_s = time_s;
  moment.camera = *camera;
  moment.sight = sight_of(world.lens, world.shutter, world.camera, *camera, time_s, shake);
  for (const Actor& actor : world.actors) {
    const auto state = actor.path.at(time_s);
    moment.states.push_back(state);
    const Twist twist = state ? twist_of(actor.path, *state, time_s, world.shutter) : Twist{};
    moment.twists.push_back(twist);
    moment.boxes.push_back(state ? projection::exact_box(moment.sight,
                                                         actor.type->silhouette,
                                                         state->world_from_body_rigid(),
                                                         actor.turned_s(time_s),
                                                         twist)
                                 : projection::ExactBox{});
    moment.search.push_back(search_box(moment.boxes.back(), actor, state, twist, moment.sight));
  }
  for (const scene::LensMark& mark : world.lens_marks)
    moment.spots.push_back(spot_of(mark, moment.sight, world.to_sun_in_world, time_s, world.seed));
  return moment;
}

std::optional<NearestApproach> nearest_approach(const World& world,
                                                std::size_t actor,
                                                double end_s) {
  std::optional<NearestApproach> best;
  const lens::ImageSize size = world.lens.size();
  // A coarse walk along the image's border.
  std::vector<Vector3> edges;
  for (int i = 0; i <= 64; ++i) {
    const double x = i / 64.0 * size.width, y = i / 64.0 * size.height;
    for (const Pixel& edge :
         {Pixel(x, 0), Pixel(x, size.height), Pixel(0, y), Pixel(size.width, y)})
      if (const auto ray = world.lens.ray_from_pixel(edge)) edges.push_back(*ray);
  }
  for (double time_s = 0; time_s <= end_s; time_s += std::max(end_s / 2000, 1e-3)) {
    const auto state = world.actors[actor].path.at(time_s);
    const auto camera = world.camera.at(time_s);
    if (!state || !camera) continue;
    const Vector3 p_in_cam =
        world_from_shaken_cam(*camera, {}, 0).inverse() * state->position_in_world;
    const auto pixel = world.lens.pixel_from_cam(p_in_cam);
    if (pixel && pixel->x() >= 0 && pixel->y() >= 0 && pixel->x() <= size.width &&
        pixel->y() <= size.height)
      return NearestApproach{time_s, 0, p_in_cam.norm()};
    double off = kPi;
    if (p_in_cam.norm() > 0)
      for (const Vector3& ray : edges)
        off = std::min(off, std::acos(std::clamp(ray.dot(p_in_cam.normalized()), -1.0, 1.0)));
    if (!best || degrees(off) < best->off_view_deg)
      best = NearestApproach{time_s, degrees(off), p_in_cam.norm()};
  }
  return best;
}

}  // namespace airtruth::setup
