// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/sight.h"

namespace airtruth::sequence {
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
  constexpr double kStep_s = 1e-3;
  const double before_s = path.at(time_s - kStep_s) ? -kStep_s : 0;
  const double after_s = path.at(time_s + kStep_s) ? kStep_s : 0;
  if (!(after_s > before_s)) return Vector3::Zero();
  const auto before = path.at(time_s + before_s);
  const auto after = path.at(time_s + after_s);
  return vector_from_rotation(rotation(*after, after_s) * rotation(*before, before_s).conjugate()) /
         (after_s - before_s);
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

}  // namespace airtruth::sequence
