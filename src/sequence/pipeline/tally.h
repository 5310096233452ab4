// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "foundation/base/log.h"
#include "picture/video/reader.h"
#include "scene/scene/scene.h"
#include "sequence/pipeline/encounter_record.h"
#include "sequence/pipeline/frame_maker.h"
#include "sequence/pipeline/render.h"
#include "sequence/setup/world.h"

// What a run counts while its frames pass, and the warnings that follow from the counts.
namespace airtruth::pipeline {

struct Tally {
  std::int64_t frames = 0;
  std::int64_t frames_visible = 0;  // at least one aircraft is visible
  std::int64_t frames_bridged = 0;  // the camera's motion was not measured
  std::int64_t frames_turned = 0;   // of these: the camera has turned beyond a homography's reach
  std::int64_t frames_damaged = 0;  // the background's data was corrupt
  std::int64_t frames_black = 0;    // the light of the intruders is assumed
  // An occluder's horizon was put where the camera's attitude has it.
  std::int64_t frames_without_horizon = 0;
  std::vector<std::int64_t> cuts;  // frames that begin a shot
  // Per intruder with a range: the first frame that shows it; empty: never visible.
  std::vector<std::optional<FirstSeen>> first_seen;
  double last_time_s = 0;  // of the last frame
};

// Counts one more frame that has been through all stages; frames come in order.
void add_frame(Tally& tally, const Work& work);

// Warns of what a user should know about a finished run: corrupt or missing frames, bridged motion,
// cuts, horizons that were not found, intruders that fly below the ground or beyond their type's
// limits, that come nearer than their stated closest approach, and that are never visible.
void warn_of_run(const Tally& tally,
                 const scene::Scene& scene,
                 const setup::World& world,
                 const video::Reader& reader,
                 const Warn& to_warn);

}  // namespace airtruth::pipeline
