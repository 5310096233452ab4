// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/meeting.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "aircraft/model/mesh.h"
#include "foundation/base/error.h"
#include "foundation/geometry/units.h"
#include "labels/projection/exact_box.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/moment.h"
#include "sequence/setup/shared_inputs.h"
#include "sequence/setup/world.h"

namespace airtruth::catalogue {
namespace {

// A smaller bank counts as straight flight.
constexpr double kStraightBankDeg = 0.01;
constexpr double kPastClip_s = 1;  // that a path goes on after the clip: chosen
// Waypoints of a turn: the largest distance between neighbours in angle and in time, and the number
// of waypoints beyond either end of the clip, where the natural spline loses its curvature (by a
// factor of 0.27 per waypoint).
constexpr double kTurnStepDeg = 4;
constexpr double kTurnStep_s = 0.5;
constexpr int kTurnMargin = 8;
// Number of steps: it bounds the time of a turn.
constexpr int kMaxTurnSteps = 100'000;

// Returns the meeting moment in seconds on the clip's clock. Where the encounter has a size, the
// moment is the time of a frame, so that the truth of that frame has the size.
double meeting_s(const Encounter& encounter, const DrawnClip& clip) {
  if (!encounter.size_px) return encounter.meeting_share * clip.duration_s();
  return clip.time_s(
      static_cast<std::int64_t>(encounter.meeting_share * static_cast<double>(clip.frames)));
}

Vector3 direction_in_world(const Encounter& encounter, const Quaternion& world_from_camera_body) {
  return world_from_camera_body * unit_vector(encounter.azimuth_deg, encounter.elevation_deg);
}

// Displacement from the meeting point after a time on the helix.
Vector3 turned(const Encounter& encounter, double turn_rate, double after_s) {
  const double heading = radians(encounter.heading_deg);
  const double climb = radians(encounter.climb_deg);
  const double over_ground_mps = encounter.speed_mps * std::cos(climb);
  const double radius_m = over_ground_mps / turn_rate;  // the sign gives the side of the turn
  const double now = heading + turn_rate * after_s;
  return {radius_m * (std::sin(now) - std::sin(heading)),
          radius_m * (std::cos(heading) - std::cos(now)),
          -encounter.speed_mps * std::sin(climb) * after_s};
}

void lay_turn(scene::Intruder& intruder,
              const Encounter& encounter,
              const Vector3& meeting,
              double meets_s,
              double clip_s) {
  const double over_ground_mps = encounter.speed_mps * std::cos(radians(encounter.climb_deg));
  const double turn_rate =
      kStandardGravityMps2 * std::tan(radians(encounter.bank_deg)) / over_ground_mps;
  const double step_s = std::min(kTurnStep_s, radians(kTurnStepDeg) / std::abs(turn_rate));
  const double begin_s = -kTurnMargin * step_s;
  const double span_s = clip_s + kPastClip_s - begin_s;
  if (!(span_s / step_s < kMaxTurnSteps))
    throw Error(
        fmt::format("bank_deg: a turn of {:.0f} degrees of bank at {:.1f} m/s over {:.0f} s "
                    "is a path of more than {} points; expected a shorter clip",
                    encounter.bank_deg,
                    encounter.speed_mps,
                    span_s,
                    kMaxTurnSteps),
        intruder.where);
  const auto steps = static_cast<int>(std::ceil(span_s / step_s)) + kTurnMargin;
  intruder.waypoints_ned_m.clear();
  for (int i = 0; i <= steps; ++i)
    intruder.waypoints_ned_m.push_back(
        meeting + turned(encounter, turn_rate, begin_s + i * step_s - meets_s));
  intruder.start_s = begin_s;
}

void lay_through(scene::Intruder& intruder,
                 const Encounter& encounter,
                 const Vector3& meeting,
                 const DrawnClip& clip) {
  const double meets_s = meeting_s(encounter, clip);
  if (std::abs(encounter.bank_deg) >= kStraightBankDeg)
    return lay_turn(intruder, encounter, meeting, meets_s, clip.duration_s());
  const Vector3 velocity =
      encounter.speed_mps * unit_vector(encounter.heading_deg, encounter.climb_deg);
  intruder.waypoints_ned_m = {meeting - meets_s * velocity,
                              meeting + (clip.duration_s() + kPastClip_s - meets_s) * velocity};
}

// The place in a direction from the camera at which the longer side of an aircraft's exact box,
// which box_at(place) gives, has a size; empty where no range gives it.
std::optional<Vector3> sized_place(const Vector3& camera_ned_m,
                                   const Vector3& direction,
                                   double size_px,
                                   double range_m,
                                   const auto& box_at) {
  constexpr double kWithinShare = 1e-5;  // of the size: chosen
  constexpr int kMaxRounds = 60;         // chosen
  constexpr double kFarthestM = 1e6;     // beyond it nothing is visible: chosen
  for (int round = 0; round < kMaxRounds; ++round) {
    Vector3 at = camera_ned_m + range_m * direction;
    if (camera_ned_m.z() < -kLowestFlightM) at.z() = std::min(at.z(), -kLowestFlightM);
    const std::optional<Box> box = box_at(at).whole();
    if (!box) {
      // A part of the aircraft is behind the camera or beyond the lens's field.
      range_m *= 2;
      if (range_m > kFarthestM) return std::nullopt;
      continue;
    }
    const double ratio = std::max(box->width, box->height) / size_px;
    if (std::abs(ratio - 1) < kWithinShare) return at;
    // At long range the product of size and range is constant.
    range_m *= ratio;
  }
  return std::nullopt;
}

trajectory::State state_at(const trajectory::Path& own, double time_s, const Where& where) {
  if (const auto state = own.at(time_s)) return *state;
  throw Error(fmt::format("the camera's path does not reach {:.2f} s, where an intruder meets it; "
                          "expected a path as long as the clip",
                          time_s),
              where);
}

// Gives the intruder the path of an encounter that states a closest approach or what is seen.
// Returns false, and changes nothing, for any other encounter.
bool lay_stated_path(scene::Intruder& intruder, const Encounter& encounter, const DrawnClip& clip) {
  if (!encounter.approach && encounter.seen.empty()) return false;
  intruder.speed_mps.reset();
  intruder.seen = encounter.seen;
  intruder.encounter = encounter.approach;
  if (encounter.approaches_at_meeting) intruder.encounter->cpa_time_s = meeting_s(encounter, clip);
  return true;
}

}  // namespace

void lay_path(scene::Intruder& intruder,
              const Encounter& encounter,
              const scene::Camera& camera,
              const DrawnClip& clip,
              double provisional_range_m) {
  if (lay_stated_path(intruder, encounter, clip)) return;
  const double meets_s = meeting_s(encounter, clip);
  const Vector3 meeting =
      camera.position_ned_m + meets_s * camera.velocity_ned_mps +
      encounter.range_m.value_or(provisional_range_m) *
          direction_in_world(
              encounter,
              world_from_body(camera.attitude_yaw_pitch_roll_deg.value_or(YawPitchRoll{})));
  lay_through(intruder, encounter, meeting, clip);
}

void meet(scene::Intruder& intruder,
          const scene::Scene& scene,
          const Encounter& encounter,
          const DrawnClip& clip,
          setup::SharedInputs* shared) {
  // Length for the first estimate of the range.
  constexpr double kUsualLengthM = 15;
  if (lay_stated_path(intruder, encounter, clip)) return;
  const double meets_s = meeting_s(encounter, clip);
  const trajectory::Path own = setup::unmeasured_camera_path(scene.camera);
  const trajectory::State camera = state_at(own, meets_s, scene.camera.where);
  const Vector3 direction = direction_in_world(encounter, camera.world_from_body);
  if (encounter.range_m) {
    lay_through(
        intruder, encounter, camera.position_in_world + *encounter.range_m * direction, clip);
    return;
  }
  const lens::Lens lens = setup::lens_of(scene.lens, clip.size);
  const double guess_m = lens.focal_px() * kUsualLengthM / *encounter.size_px;
  lay_through(intruder, encounter, camera.position_in_world + guess_m * direction, clip);
  const trajectory::Path path = setup::path_of(intruder, own);
  setup::SharedInputs unshared;
  const auto type = (shared != nullptr ? *shared : unshared).type_of(intruder, path, {}, {});
  const projection::Sight sight = setup::sight_of(lens, {}, own, camera, meets_s, {});
  const Quaternion attitude = path.at(meets_s)->world_from_body;
  const auto position = sized_place(
      camera.position_in_world, direction, *encounter.size_px, guess_m, [&](const Vector3& at) {
        return projection::exact_box(
            sight, type->silhouette, Rigid{attitude, at}, meets_s + intruder.spin_time_s);
      });
  if (!position)
    throw Error(
        fmt::format("{} has a size of {:.1f} px at no range in the direction azimuth {:.1f}, "
                    "elevation {:.1f} degrees through this lens",
                    encounter.aircraft,
                    *encounter.size_px,
                    encounter.azimuth_deg,
                    encounter.elevation_deg),
        intruder.where);
  lay_through(intruder, encounter, *position, clip);
}

}  // namespace airtruth::catalogue
