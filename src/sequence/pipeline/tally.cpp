// SPDX-License-Identifier: Apache-2.0
#include "sequence/pipeline/tally.h"

#include <cstdio>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "labels/annotation/object_class.h"
#include "sequence/setup/flyable.h"

namespace airtruth::pipeline {
namespace {

// A turn may bring an intruder nearer within the clip than at the closest approach that its scene
// states.
void warn_nearer(const scene::Intruder& intruder,
                 const setup::Actor& actor,
                 const trajectory::Path& own,
                 double last_time_s,
                 const Warn& to_warn) {
  constexpr double kNearerM = 0.1;  // a smaller difference is not worth a warning: chosen
  if (!intruder.encounter) return;
  const double cpa_time_s = intruder.encounter->cpa_time_s;
  const auto stated = passage::closest_approach(own, actor.path, cpa_time_s, cpa_time_s);
  const auto nearest = passage::closest_approach(own, actor.path, 0, last_time_s);
  if (!stated || !nearest || nearest->distance_m > stated->distance_m - kNearerM) return;
  warn(to_warn,
       fmt::format("{}: intruder '{}' comes nearer than at its cpa_time_s of {:.2f} s: {:.1f} m in "
                   "place of {:.1f} m, at {:.2f} s",
                   to_string(intruder.where),
                   actor.id,
                   cpa_time_s,
                   nearest->distance_m,
                   stated->distance_m,
                   nearest->time_s));
}

void warn_never_seen(const scene::Intruder& intruder,
                     const setup::World& world,
                     std::size_t i,
                     double last_time_s,
                     const Warn& to_warn) {
  std::string text =
      to_string(intruder.where) + ": intruder '" + world.actors[i].id + "' is never visible";
  const auto nearest = setup::nearest_approach(world, i, last_time_s);
  if (nearest && nearest->off_view_deg <= 0) {
    text += fmt::format(
        "; it is in view at {:.2f} s, but changes no pixel there: something hides it, or it is as "
        "bright as the picture behind it",
        nearest->time_s);
  } else if (nearest) {
    text += fmt::format(
        "; it comes nearest to the view's edge at {:.2f} s, {:.1f} degrees from it, at a range of "
        "{:.0f} m",
        nearest->time_s,
        nearest->off_view_deg,
        nearest->range_m);
  } else {
    text += "; its path does not overlap the clip in time";
  }
  warn(to_warn, text);
}

void warn_of_video(const Tally& tally,
                   const scene::Background& background,
                   const video::Reader& reader,
                   const Warn& to_warn) {
  const std::string video = background.video.string();
  if (reader.corrupt_packets() > 0 || tally.frames_damaged > 0)
    warn(to_warn,
         fmt::format("{}: {} corrupt packets; {} frames are flagged damaged",
                     video,
                     reader.corrupt_packets(),
                     tally.frames_damaged));
  if (tally.frames_black > 0)
    warn(to_warn,
         fmt::format("{}: {} frames are black, and show no light; there the intruders have that of "
                     "an overcast sky, or what [light] states",
                     video,
                     tally.frames_black));
  if (reader.ends_early())
    warn(to_warn, fmt::format("{}: ends early, after {} frames", video, tally.frames));
  if (background.frame_count && tally.frames < *background.frame_count)
    warn(to_warn,
         fmt::format("{}: frame_count is {}, but the video holds {} frames from first_frame on",
                     to_string(background.where),
                     *background.frame_count,
                     tally.frames));
}

void warn_of_motion(const Tally& tally, const scene::Background& background, const Warn& to_warn) {
  if (tally.frames_bridged > 0)
    warn(
        to_warn,
        fmt::format("the camera's motion could not be measured in {} frames; they are bridged, and "
                    "truth.jsonl says which",
                    tally.frames_bridged));
  if (!tally.cuts.empty())
    warn(to_warn,
         fmt::format(
             "{}: the video is cut at frame {}: nothing links the camera's pose and light to "
             "the frames before",
             background.video.string(),
             fmt::join(tally.cuts, ", ")));
  if (tally.frames_turned > 0)
    warn(to_warn,
         fmt::format(
             "in {} of them the camera has turned so far from the first frame that no homography "
             "holds "
             "both; expected [motion] reference = \"smoothed\", or model = \"rotation\" with the "
             "camera's lens",
             tally.frames_turned));
}

}  // namespace

void add_frame(Tally& tally, const Work& work) {
  const video::Frame& frame = work.frame;
  const annotation::Frame& truth = work.truth;
  const motion::State motion = work.moved.motion.state;
  ++tally.frames;
  tally.last_time_s = frame.time_s;
  tally.first_seen.resize(truth.intruders.size());
  bool any = false;
  for (std::size_t i = 0; i < truth.intruders.size(); ++i) {
    const bool visible = truth.intruders[i].state == annotation::State::kVisible;
    any = any || (visible && annotation::is_aircraft(truth.intruders[i].object_class));
    if (!tally.first_seen[i]) tally.first_seen[i] = seen_in(truth, truth.intruders[i]);
  }
  tally.frames_visible += any ? 1 : 0;
  tally.frames_bridged += motion::is_known(motion) ? 0 : 1;
  tally.frames_turned += motion == motion::State::kTurnedAway ? 1 : 0;
  tally.frames_damaged += frame.damaged ? 1 : 0;
  tally.frames_black += work.ambient.is_assumed ? 1 : 0;
  tally.frames_without_horizon += work.horizon_is_assumed ? 1 : 0;
  if (frame.begins_shot) tally.cuts.push_back(frame.index);
}

void warn_of_run(const Tally& tally,
                 const scene::Scene& scene,
                 const setup::World& world,
                 const video::Reader& reader,
                 const Warn& to_warn) {
  warn_of_video(tally, scene.background, reader, to_warn);
  warn_of_motion(tally, scene.background, to_warn);
  if (tally.frames_without_horizon > 0)
    warn(to_warn,
         fmt::format("[[occluder]] beyond_horizon: {} frames show no horizon; in them it is where "
                     "the camera's attitude and its measured motion have it",
                     tally.frames_without_horizon));
  setup::warn_below_ground(scene, world, tally.last_time_s, to_warn);
  for (std::size_t i = 0; i < world.actors.size(); ++i) {
    setup::warn_not_flyable(scene.intruders[i], world.actors[i].path, tally.last_time_s, to_warn);
    warn_nearer(scene.intruders[i], world.actors[i], world.camera, tally.last_time_s, to_warn);
    if (i >= tally.first_seen.size() || !tally.first_seen[i])
      warn_never_seen(scene.intruders[i], world, i, tally.last_time_s, to_warn);
  }
}

}  // namespace airtruth::pipeline
