// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/seen.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/geometry/box.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/world.h"

namespace airtruth::setup {
namespace {

// How long the path goes on beyond the first and the last moment.
constexpr double kBeyond_s = 3600;
// Farthest place of an intruder whose width is stated; beyond it nothing is visible.
constexpr double kFarthestM = 1e6;

// A moment with its frame, and the ray on which the aircraft's reference point is placed.
struct Ray {
  const scene::Seen* seen = nullptr;
  double frame_s = 0;
  projection::Sight sight;  // at the frame's time
  // The pixel of the ray. It is the stated one less the way from the reference point to the middle
  // of the box.
  Pixel pixel = Pixel::Zero();
  // When the pixel's own row is exposed.
  double time_s = 0;
  Vector3 from_ned_m = Vector3::Zero();
  Vector3 direction_in_world = Vector3::Zero();
  double range_m = 0;
};

[[noreturn]] void refuse_pixel(const scene::Seen& seen, const char* reason) {
  throw Error(fmt::format("pixel [{}, {}] {}; expected a pixel that the lens shows",
                          seen.pixel.x(),
                          seen.pixel.y(),
                          reason),
              seen.where);
}

void aim(Ray& ray, const World& world, const Pixel& pixel) {
  const lens::ImageSize size = world.lens.size();
  const Pixel inside(std::clamp(pixel.x(), 0.0, double(size.width)),
                     std::clamp(pixel.y(), 0.0, double(size.height)));
  const double dt_s = world.shutter.middle_s(inside, size.width, size.height);
  const projection::Sight then = dt_s == 0 ? ray.sight : ray.sight.at(dt_s);
  const Pixel nominal = apply(then.frame_from_nominal.inverse(), pixel);
  if (!nominal.allFinite()) refuse_pixel(*ray.seen, "is on the horizon of the frame's homography");
  const auto in_cam = world.lens.ray_from_pixel(nominal);
  if (!in_cam) refuse_pixel(*ray.seen, "is beyond the lens's field");
  const Rigid world_from_cam = then.cam_from_world.inverse();
  ray.pixel = pixel;
  ray.time_s = ray.frame_s + dt_s;
  ray.from_ned_m = world_from_cam.translation;
  ray.direction_in_world = world_from_cam.rotation * *in_cam;
}

Ray ray_of(const scene::Seen& seen, const World& world, const FrameNear& frame_near) {
  const FramePose frame = frame_near(seen);
  const auto camera = world.camera.at(frame.time_s);
  if (!camera)
    throw Error(
        fmt::format("time_s is {:.3f}, which the camera's path does not reach", seen.time_s),
        seen.where);
  Ray ray{.seen = &seen, .frame_s = frame.time_s};
  ray.sight = sight_of(world.lens, world.shutter, world.camera, *camera, frame.time_s, frame.shake);
  aim(ray, world, seen.pixel);
  ray.range_m =
      seen.range_m ? *seen.range_m : world.lens.focal_px() * kUsualLengthM / *seen.width_px;
  return ray;
}

std::vector<Ray> rays_of(const scene::Intruder& intruder,
                         const World& world,
                         const FrameNear& frame_near) {
  std::vector<Ray> rays;
  for (const scene::Seen& seen : intruder.seen) {
    rays.push_back(ray_of(seen, world, frame_near));
    if (rays.size() > 1 && !(rays.back().frame_s > rays[rays.size() - 2].frame_s))
      throw Error(fmt::format("time_s is {:.3f}, whose frame, at {:.3f} s, is that of the moment "
                              "before; expected another frame",
                              seen.time_s,
                              rays.back().frame_s),
                  seen.where);
  }
  return rays;
}

// The natural spline ends without curvature, so straight legs at both ends leave it as it is.
void add_straight_legs(std::vector<Vector3>& points, std::vector<double>& times_s) {
  const trajectory::Path inner = trajectory::spline_at_times(points, times_s);
  const trajectory::State first = *inner.at(times_s.front());
  const trajectory::State last = *inner.at(times_s.back());
  points.insert(points.begin(), points.front() - kBeyond_s * first.velocity_in_world_mps);
  times_s.insert(times_s.begin(), times_s.front() - kBeyond_s);
  points.push_back(points.back() + kBeyond_s * last.velocity_in_world_mps);
  times_s.push_back(times_s.back() + kBeyond_s);
}

scene::Intruder through_places(const scene::Intruder& intruder, const std::vector<Ray>& rays) {
  scene::Intruder result = intruder;
  result.seen.clear();
  result.waypoints_ned_m.clear();
  for (const Ray& ray : rays) {
    result.waypoints_ned_m.push_back(ray.from_ned_m + ray.range_m * ray.direction_in_world);
    result.times_s.push_back(ray.time_s);
    const std::size_t n = result.times_s.size();
    if (n < 2) continue;
    const double step_m = (result.waypoints_ned_m[n - 1] - result.waypoints_ned_m[n - 2]).norm();
    const double step_s = result.times_s[n - 1] - result.times_s[n - 2];
    if (!(step_m <= kFastestMps * step_s))
      throw Error(fmt::format("the place is {:.0f} m from the one before, {:.3f} s earlier, which "
                              "needs {:.0f} m/s; expected less than {:.0f} m/s",
                              step_m,
                              step_s,
                              step_m / step_s,
                              kFastestMps),
                  ray.seen->where);
    if (!(step_m > 1e-6))
      throw Error("the place is the same as the one before; expected one that moves",
                  ray.seen->where);
  }
  add_straight_legs(result.waypoints_ned_m, result.times_s);
  return result;
}

// Empty where a part of the aircraft has no pixel.
std::optional<Box> whole_box(const Ray& ray,
                             const trajectory::Path& path,
                             const World& world,
                             const projection::SilhouettePoints& aircraft,
                             double spin_time_s) {
  const auto state = path.at(ray.frame_s);
  check(state.has_value(), "the path reaches its own moments");
  return projection::exact_box(ray.sight,
                               aircraft,
                               state->world_from_body_rigid(),
                               ray.frame_s + spin_time_s,
                               twist_of(path, *state, ray.frame_s, world.shutter))
      .whole();
}

// Moves each place until the middle of the box is at the stated pixel, and where a width is stated
// to the range that gives it. The attitudes follow from all places, so that they are moved
// together.
void settle_boxes(scene::Intruder intruder,
                  const World& world,
                  const projection::SilhouettePoints& aircraft,
                  std::vector<Ray>& rays) {
  // Largest number of rounds: it ends a search for a width that no range gives.
  constexpr int kMaxRounds = 200;
  // From this round on the steps are halved, and again after so many more, for attitudes, and the
  // moments at which rows see a rotor, that answer to the places.
  constexpr int kDampedRound = 20;
  constexpr int kRoundsOfStep = 60;
  // What is seen is the middle of a flock: its birds keep their places about it.
  intruder.offset_ned_m = Vector3::Zero();
  const Ray* off = nullptr;
  for (int round = 0; round < kMaxRounds; ++round) {
    const trajectory::Path path = path_of(through_places(intruder, rays), world.camera);
    const double step =
        round < kDampedRound ? 1 : std::pow(0.5, 1 + (round - kDampedRound) / kRoundsOfStep);
    off = nullptr;
    bool is_settled = true;
    for (Ray& ray : rays) {
      const auto box = whole_box(ray, path, world, aircraft, intruder.spin_time_s);
      if (box && meets_frame({ray.seen->pixel.x(), ray.seen->pixel.y(), 0, 0}, world.lens.size())) {
        const Pixel miss = ray.seen->pixel - centre_of(*box);
        is_settled = is_settled && miss.norm() <= kMiddlePx;
        aim(ray, world, ray.pixel + step * miss);
      }
      if (!ray.seen->width_px) continue;
      const double share = box ? box->width / *ray.seen->width_px : 2;
      if (std::abs(share - 1) > kWidthShare) off = &ray;
      ray.range_m *= std::pow(share, step);
      ray.range_m = std::min(ray.range_m, kFarthestM);
    }
    if (off == nullptr && is_settled) return;
  }
  if (off == nullptr) return;
  throw Error(
      fmt::format("no range gives {} a width_px of {} at this pixel; expected another width, "
                  "or range_m",
                  intruder.aircraft,
                  *off->seen->width_px),
      off->seen->where);
}

}  // namespace

FramePose steady_frame(const scene::Seen& seen) { return {seen.time_s, {}}; }

scene::Intruder placed_as_seen(const scene::Intruder& intruder,
                               const World& world,
                               const FrameNear& frame_near,
                               const projection::SilhouettePoints* aircraft) {
  check(intruder.seen.size() >= 2, "an intruder is seen at two moments or more");
  std::vector<Ray> rays = rays_of(intruder, world, frame_near);
  if (aircraft != nullptr) settle_boxes(intruder, world, *aircraft, rays);
  return through_places(intruder, rays);
}

}  // namespace airtruth::setup
