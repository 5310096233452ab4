// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/moment.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "foundation/base/error.h"
#include "sequence/setup/lens_marks.h"
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

// Returns the whole frame, for an aircraft so near that a part of it has no pixel.
Box whole(const lens::ImageSize& size) { return {0, 0, double(size.width), double(size.height)}; }

std::optional<Box> search_box(const projection::ExactBox& exact, const lens::ImageSize& size) {
  if (!exact.box) return std::nullopt;
  const Box box = exact.partly_unseen ? whole(size) : wider(*exact.box, kSearchMarginPx);
  if (!meets_frame(box, size)) return std::nullopt;
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

Moment moment_at(const World& world, std::int64_t frame, double time_s, const Shake& shake) {
  const auto camera = world.camera.at(time_s);
  if (!camera)
    throw Error("the camera's path ends at " + std::to_string(world.camera.end_s()) +
                " s, but the clip goes on at " + std::to_string(time_s) +
                " s; expected a path as long as the clip");
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
    moment.search.push_back(search_box(moment.boxes.back(), world.lens.size()));
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
