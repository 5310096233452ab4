// SPDX-License-Identifier: Apache-2.0
#include "studio/session/near_miss.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "encounter/placement/near_miss.h"
#include "foundation/base/error.h"
#include "foundation/geometry/box.h"
#include "labels/projection/exact_box.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/world.h"
#include "studio/session/answers.h"

namespace airtruth::session {
namespace {

// Rounds in which the place follows from the box, whose shape follows from the course: each leaves
// some hundredth of what was off.
constexpr int kRounds = 6;

std::size_t actor_of(const Stage& stage,
                     const std::vector<document::TablePlace>& tables,
                     std::size_t intruder) {
  const auto table = std::find_if(tables.begin(), tables.end(), [&](const auto& place) {
    return place.array == "intruder" && place.index == intruder;
  });
  const auto& all = stage.scene().intruders;
  const auto found = std::find_if(all.begin(), all.end(), [&](const scene::Intruder& one) {
    return table != tables.end() && one.where.line == table->line;
  });
  if (found == all.end()) throw Error(fmt::format("there is no intruder {}", intruder));
  return static_cast<std::size_t>(found - all.begin());
}

// The intruder on the path of an encounter, in the frame of a moment.
struct Try {
  scene::Encounter encounter;
  std::optional<Pixel> middle;  // of the exact box, where it is whole
};

Try tried(const placement::NearMiss& wanted,
          const Stage& stage,
          std::size_t actor,
          const projection::Sight& sight) {
  const setup::World& world = stage.world();
  Try result{placement::encounter_of(wanted, world.camera), {}};
  scene::Intruder intruder = stage.scene().intruders[actor];
  intruder.waypoints_ned_m.clear();
  intruder.times_s.clear();
  intruder.seen.clear();
  intruder.encounter = result.encounter;
  const trajectory::Path path = setup::path_of(intruder, world.camera);
  const auto state = path.at(wanted.time_s);
  check(state.has_value(), "the path of an encounter has no end");
  const auto exact = projection::exact_box(
      sight, world.actors[actor].type->silhouette, state->world_from_body_rigid(), wanted.time_s);
  if (exact.box && !exact.partly_unseen) result.middle = centre_of(*exact.box);
  return result;
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
  return result;
}

}  // namespace

nlohmann::ordered_json encounter_through(const Stage& stage,
                                         const std::vector<document::TablePlace>& tables,
                                         const messages::NearMiss& wanted) {
  if (!stage.has_motion())
    throw Error(
        "the clip's motion, from which the place of a pixel follows, is still measured; "
        "expected to wait until it is");
  const std::size_t actor = actor_of(stage, tables, wanted.intruder);
  const std::vector<scene::Seen>& seen = stage.stated_seen(actor);
  if (wanted.moment >= seen.size())
    throw Error(fmt::format("intruder {} has no moment {}", wanted.intruder, wanted.moment));
  const scene::Seen& moment = seen[wanted.moment];
  const setup::World& world = stage.world();
  const auto frame = static_cast<std::int64_t>(std::llround(moment.time_s * stage.clip_rate_hz()));
  const double time_s = stage.time_s(frame);
  const auto camera = world.camera.at(time_s);
  const auto state = world.actors[actor].path.at(time_s);
  const auto sight = stage.sight_at(frame);
  check(camera && state && sight, "the paths reach their own moments");
  placement::NearMiss near_miss{.place_ned_m = state->position_in_world,
                                .time_s = time_s,
                                .miss_m = wanted.miss_m,
                                .is_right = wanted.is_right,
                                .speed_mps = wanted.speed_mps};
  Try last = tried(near_miss, stage, actor, *sight);
  const bool is_in_frame =
      setup::meets_frame({moment.pixel.x(), moment.pixel.y(), 0, 0}, world.lens.size());
  for (int round = 0; round < kRounds && is_in_frame && last.middle; ++round) {
    near_miss.place_ned_m = moved(
        *sight, camera->position_in_world, near_miss.place_ned_m, moment.pixel - *last.middle);
    last = tried(near_miss, stage, actor, *sight);
  }
  return stated(last.encounter);
}

}  // namespace airtruth::session
