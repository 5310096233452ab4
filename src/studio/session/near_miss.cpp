// SPDX-License-Identifier: Apache-2.0
#include "studio/session/near_miss.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "encounter/placement/by_approach.h"
#include "foundation/base/error.h"
#include "foundation/geometry/box.h"
#include "foundation/json/or_null.h"
#include "labels/projection/exact_box.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/world.h"
#include "studio/session/plan.h"

namespace airtruth::session {
namespace {

// Rounds in which the place follows from the box, whose shape follows from the course: each leaves
// some hundredth of what was off.
constexpr int kRounds = 6;

std::size_t actor_of(const Stage& stage, const document::Tables& tables, std::size_t intruder) {
  const nlohmann::ordered_json wanted = {"intruder", intruder};
  const auto& all = stage.scene().intruders;
  const auto found = std::ranges::find_if(
      all, [&](const scene::Intruder& one) { return table_at(tables, one.where) == wanted; });
  if (found == all.end()) throw Error(fmt::format("there is no intruder {}", intruder));
  return static_cast<std::size_t>(found - all.begin());
}

// The middle of the exact box, where it is whole and in the frame.
std::optional<Pixel> middle_of(const Stage& stage,
                               std::size_t actor,
                               const trajectory::Path& path,
                               const projection::Sight& sight,
                               double time_s) {
  const setup::World& world = stage.world();
  const auto state = path.at(time_s);
  if (!state) return std::nullopt;
  const auto box = projection::exact_box(sight,
                                         world.actors[actor].type->silhouette,
                                         state->world_from_body_rigid(),
                                         world.actors[actor].turned_s(time_s),
                                         setup::twist_of(path, *state, time_s, world.shutter))
                       .whole();
  if (!box) return std::nullopt;
  const Pixel middle = centre_of(*box);
  return setup::meets_frame({middle.x(), middle.y(), 0, 0}, world.lens.size())
             ? std::optional(middle)
             : std::nullopt;
}

trajectory::Path path_of(const scene::Encounter& encounter, const Stage& stage, std::size_t actor) {
  scene::Intruder intruder = stage.scene().intruders[actor];
  intruder.waypoints_ned_m.clear();
  intruder.times_s.clear();
  intruder.seen.clear();
  intruder.encounter = encounter;
  return setup::path_of(intruder, stage.world().camera);
}

// A place beside `place`, as far from the camera, whose pixel lies `by_px` further.
Vector3 moved(const projection::Sight& sight,
              const Vector3& from,
              const Vector3& place,
              const Pixel& by_px) {
  const Vector3 off = place - from;
  const Vector3 across[] = {off.unitOrthogonal(), off.normalized().cross(off.unitOrthogonal())};
  const auto pixel = projection::pixel_from_world(sight, place);
  Eigen::Matrix2d px_of_m;
  for (int i = 0; i < 2; ++i) {
    const auto beside = projection::pixel_from_world(sight, place + across[i]);
    if (!pixel || !beside) return place;
    px_of_m.col(i) = *beside - *pixel;
  }
  const Eigen::Vector2d by_m = px_of_m.colPivHouseholderQr().solve(by_px);
  return from + off.norm() * (off + by_m.x() * across[0] + by_m.y() * across[1]).normalized();
}

nlohmann::ordered_json stated(const scene::Encounter& encounter) {
  nlohmann::ordered_json result = {{"cpa_time_s", rounded(encounter.cpa_time_s, 1e-4)}};
  if (encounter.cpa_right_m) result["cpa_right_m"] = rounded(*encounter.cpa_right_m, 0.01);
  if (encounter.cpa_ahead_m) result["cpa_ahead_m"] = rounded(*encounter.cpa_ahead_m, 0.01);
  result["cpa_above_m"] = rounded(encounter.cpa_above_m, 0.01);
  result["course_deg"] = rounded(encounter.course_deg, 0.001);
  result["speed_mps"] = rounded(encounter.speed_mps, 1e-3);
  if (encounter.climb_mps != 0) result["climb_mps"] = rounded(encounter.climb_mps, 1e-3);
  return result;
}

}  // namespace

nlohmann::ordered_json encounter_through(const Stage& stage,
                                         const document::Tables& tables,
                                         const messages::NearMiss& wanted) {
  if (!stage.has_motion())
    throw Error(
        "the clip's motion, from which the place of a pixel follows, is still measured; "
        "expected to wait until it is");
  const std::size_t actor = actor_of(stage, tables, wanted.intruder);
  const setup::World& world = stage.world();
  const double time_s = stage.time_s(wanted.frame);
  const auto camera = world.camera.at(time_s);
  const auto state = world.actors[actor].path.at(time_s);
  const auto sight = stage.sight_at(wanted.frame);
  if (!camera || !state || !sight)
    throw Error(fmt::format("the intruder is not in the world at {:.2f} s", time_s));
  const auto pixel = middle_of(stage, actor, world.actors[actor].path, *sight, time_s);
  placement::NearMiss near_miss{.place_ned_m = state->position_in_world,
                                .time_s = time_s,
                                .miss_m = wanted.miss_m,
                                .is_right = wanted.is_right,
                                .speed_mps = wanted.speed_mps,
                                .above_m = wanted.above_m};
  scene::Encounter encounter = placement::encounter_of(near_miss, world.camera);
  for (int round = 0; round < kRounds && pixel; ++round) {
    const auto middle = middle_of(stage, actor, path_of(encounter, stage, actor), *sight, time_s);
    if (!middle) break;
    near_miss.place_ned_m =
        moved(*sight, camera->position_in_world, near_miss.place_ned_m, *pixel - *middle);
    encounter = placement::encounter_of(near_miss, world.camera);
  }
  return stated(encounter);
}

}  // namespace airtruth::session
