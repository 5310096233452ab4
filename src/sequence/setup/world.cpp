// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/world.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "aircraft/shapes/shapes.h"
#include "aircraft/wrapper/reader.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/geometry/units.h"
#include "labels/annotation/object_class.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/shared_inputs.h"

namespace airtruth::setup {
namespace {

// An aircraft's configuration is that of the nearest of these steps. Propellers that turn with the
// airspeed and flaps that follow it would else make each path's aircraft one of its own, with its
// BVH and textures. Chosen: 20 kt are within a sixth of the slowest usual speed.
constexpr double kAirspeedStepKt = 20;
constexpr double kHeightStepFt = 100;

double nearest_step(double value, double step) { return step * std::round(value / step); }

// The aircraft as labels name it. A model file is named from the scene's folder, and one that does
// not lie below it by its own name and content: the same scene gives the same labels wherever it
// lies, however its path is spelt.
std::string name_in_labels(const scene::Intruder& intruder) {
  if (intruder.distractor || !wrapper::is_model_file(intruder.aircraft)) return intruder.aircraft;
  const fs::path model = fs::weakly_canonical(fs::absolute(intruder.aircraft));
  const fs::path folder = fs::weakly_canonical(fs::absolute(intruder.where.file)).parent_path();
  const fs::path below = model.lexically_relative(folder);
  if (!below.empty() && *below.begin() != "..") return below.string();
  return fmt::format("{} sha256:{}", model.filename().string(), sha256_of_file(model));
}

// Of a flown intruder: its path has no `seen` left.
Actor actor_of(const scene::Intruder& intruder,
               const World& world,
               SharedInputs& types,
               const Warn& warn,
               const std::stop_token& stop) {
  const trajectory::Path path = path_of(intruder, world.camera);
  const auto type =
      at_place(intruder.where, [&] { return types.type_of(intruder, path, warn, stop); });
  const char* object_class =
      intruder.distractor ? enum_name(intruder.distractor->kind) : annotation::kAircraft.data();
  return {intruder.id, name_in_labels(intruder), object_class, path, type, intruder.spin_time_s};
}

// An aircraft that is to be seen at a width is placed by its usual length, loaded for the airspeed
// and height there, and placed and loaded once more by its own shape. The intruder then has
// waypoints in place of what is seen.
Actor load_actor(scene::Intruder& intruder,
                 const World& world,
                 const FrameNear& frame_near,
                 SharedInputs& types,
                 const Warn& warn,
                 const std::stop_token& stop) {
  if (intruder.seen.empty()) return actor_of(intruder, world, types, warn, stop);
  const Actor first =
      actor_of(placed_as_seen(intruder, world, frame_near, nullptr), world, types, warn, stop);
  intruder = placed_as_seen(intruder, world, frame_near, &first.type->silhouette);
  return actor_of(intruder, world, types, {}, stop);
}

model::Mesh mesh_of(const scene::Distractor& one) {
  switch (one.kind) {
    case scene::DistractorKind::kBird:
      return shapes::bird(
          {one.size_m, one.aspect_ratio, one.plumage, one.flap_hz, one.flap_phase, one.glide});
    case scene::DistractorKind::kMultirotor:
      return shapes::multirotor({one.size_m, one.rotors, one.colour, one.arm_colour});
    case scene::DistractorKind::kBalloon:
      return shapes::balloon({one.size_m, one.colour});
    default:
      break;
  }
  check(false, "a distractor in the air has a mesh");
  return {};
}

World without_actors(const scene::Scene& scene, lens::ImageSize size, const Warn& warn) {
  return {lens_of(scene.lens, size, warn),
          at_place(scene.camera.where, [&] { return camera_path(scene.camera, warn); }),
          {},
          shutter_of(scene.camera_model),
          volumes_of(scene.truth),
          scene.truth.lookahead_s,
          scene.lens_marks,
          to_sun_in_world(scene.light),
          scene.seed,
          scene.camera.where};
}

}  // namespace

model::LoadOptions load_options(const scene::Intruder& intruder,
                                const trajectory::Path& path,
                                const std::stop_token& stop) {
  model::LoadOptions options;
  options.stop = stop;
  // A path may begin long before the clip, as those of [[intruder.seen]] do.
  const double begin_s = std::clamp(0.0, path.start_s(), path.end_s());
  if (const auto state = path.at(begin_s)) {
    options.airspeed_kt =
        nearest_step(state->velocity_in_world_mps.norm() / kMpsOfKnot, kAirspeedStepKt);
    options.altitude_agl_ft =
        nearest_step(std::max(0.0, -state->position_in_world.z()) / kMetresOfFoot, kHeightStepFt);
  }
  options.catalogue_scale = intruder.catalogue_scale;
  options.axes = model::stated_axes(intruder.model_forward.value_or(""),
                                    intruder.model_up.value_or(""),
                                    intruder.model_scale.value_or(0));
  return options;
}

fleet::Aircraft aircraft_of(const scene::Intruder& intruder,
                            const trajectory::Path& path,
                            const Warn& warn,
                            const std::stop_token& stop) {
  if (intruder.distractor) {
    fleet::Aircraft made;
    made.name = intruder.aircraft;
    made.mesh = mesh_of(*intruder.distractor);
    return made;
  }
  return fleet::load_aircraft(intruder.aircraft, load_options(intruder, path, stop), warn);
}

World load_world(const scene::Scene& scene,
                 lens::ImageSize size,
                 const Warn& warn,
                 const std::stop_token& stop,
                 SharedInputs* shared) {
  World world = without_actors(scene, size, warn);
  SharedInputs own;
  SharedInputs& types = shared != nullptr ? *shared : own;
  for (scene::Intruder intruder : scene.intruders)
    world.actors.push_back(load_actor(intruder, world, steady_frame, types, warn, stop));
  return world;
}

void place_seen(scene::Scene& scene,
                World& world,
                const FrameNear& frame_near,
                const std::stop_token& stop,
                SharedInputs* shared) {
  SharedInputs own;
  SharedInputs& types = shared != nullptr ? *shared : own;
  for (std::size_t i = 0; i < scene.intruders.size(); ++i)
    if (!scene.intruders[i].seen.empty())
      world.actors[i] = load_actor(scene.intruders[i], world, frame_near, types, {}, stop);
}

void check_camera_path(const World& world, const video::StreamInfo& info, const Warn& warn) {
  const trajectory::Path& camera = world.camera;
  const double rate_hz = info.frame_rate.value();
  const std::int64_t last = std::max<std::int64_t>(0, info.frame_count_estimate - 1);
  const double clip_s = rate_hz > 0 ? static_cast<double>(last) / rate_hz : 0;
  const auto words = [&](const char* what, double path_s) {
    return fmt::format(
        "the camera's path {} at {:.3f} s, but the clip goes from 0 to about "
        "{:.3f} s; expected a path as long as the clip (of a log with attitudes "
        "that turn the camera these too), or a frame_count",
        what,
        path_s,
        clip_s);
  };
  // A container may state some frames more than it holds.
  constexpr double kLengthError_s = 1;
  if (!camera.at(0)) throw Error(words("begins", camera.start_s()), world.camera_where);
  if (!(camera.end_s() < clip_s - kLengthError_s)) return;
  const Error ends(words("ends", camera.end_s()), world.camera_where);
  if (info.is_frame_count_stated) throw ends;
  // An estimated number may be any more than the clip's; moment_at() refuses where the path ends.
  airtruth::warn(warn, ends.what());
}

void check_paths(const scene::Scene& scene, const video::StreamInfo& info) {
  const World world = without_actors(scene, {info.width, info.height}, {});
  check_camera_path(world, info, {});
  for (const scene::Intruder& intruder : scene.intruders) {
    if (is_aircraft(intruder))
      at_place(intruder.where, [&] { return fleet::aircraft_file(intruder.aircraft); });
    path_of(
        intruder.seen.empty() ? intruder : placed_as_seen(intruder, world, steady_frame, nullptr),
        world.camera);
  }
}

}  // namespace airtruth::setup
