// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "labels/annotation/truth.h"
#include "picture/video/reader.h"
#include "sequence/insertion/paint.h"
#include "sequence/setup/moment.h"
#include "sequence/setup/world.h"

// The truth of one frame, put together in one place: for the run that makes the frame, and for the
// check that makes it again and compares.
namespace airtruth::insertion {

// frame: the background's frame, for its number, time and damage. motion_state: "measured",
// "bridged", ... (enum_names of motion::State), or "none" without a motion model. moment: where
// everything is, from geometry alone. painted: what compositing changed in the frame's pixels,
// which `frame` holds as they are then. The intruders stand in the scene's order. An intruder is
// kVisible exactly when at least one pixel shows it.
annotation::Frame frame_truth(const setup::World& world,
                              const video::Frame& frame,
                              const std::string& motion_state,
                              const Shake& shake,
                              const setup::Moment& moment,
                              const Painted& painted);

}  // namespace airtruth::insertion
