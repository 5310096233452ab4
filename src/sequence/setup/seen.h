// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "labels/projection/exact_box.h"
#include "scene/scene/scene.h"
#include "sequence/setup/moment.h"

namespace airtruth::setup {

struct World;

// A frame as far as the places in its picture are concerned: its time and how the camera shook.
struct FramePose {
  double time_s = 0;
  Shake shake;
};
// The frame nearest to the moment; throws Error where the clip has none there.
using FrameNear = std::function<FramePose(const scene::Seen&)>;
// Before the motion is measured: a frame at that very time, without shake.
FramePose steady_frame(const scene::Seen& seen);

// Returns the intruder with waypoints_ned_m and times_s in place of `seen`. In the frame of each
// moment the exact box of `aircraft` in its attitude there has its middle at the stated pixel,
// within kMiddlePx, and its reference point is at the stated range: a place on a ray through the
// lens, the measured motion of the frame and the nominal pose at that time (with a rolling shutter:
// of its row). A bird of a flock is placed so without its offset from the flock's middle. Where the
// stated pixel is outside the frame, or a part of the aircraft has no pixel, the reference point is
// at the stated one: far outside the frame a box is no measure of a place. Where attitudes answer
// so strongly to the places that the search does not settle, the middle is as near as it came.
// Between the places the path is the natural cubic spline, and it goes on straight for an hour
// beyond both ends.
//
// Where a width is stated, the range is the one at which the exact box has this width, within
// kWidthShare of it. nullptr: the aircraft is a point, kUsualLengthM wide in any attitude.
//
// Throws Error at the moment's place: its pixel is beyond the lens's field, its frame is that of
// the moment before, no range gives the width, the camera's path does not reach it, or the path
// there is faster than kFastestMps.
scene::Intruder placed_as_seen(const scene::Intruder& intruder,
                               const World& world,
                               const FrameNear& frame_near,
                               const projection::SilhouettePoints* aircraft);

// Largest relative error of a width.
constexpr double kWidthShare = 1e-4;
// Largest distance between the middle of a box and its stated pixel; a hundredth of what a label
// may be off.
constexpr double kMiddlePx = 1e-3;
// A choice, from which the ranges of widths are first guessed.
constexpr double kUsualLengthM = 15;
constexpr double kFastestMps = 1e4;  // as scene::kSpeed

}  // namespace airtruth::setup
