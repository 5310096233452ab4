// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "scene/flight_log/flight_log.h"
#include "scene/scene/scene.h"
#include "scene/trajectory/path.h"

// Where the own aircraft really flew: the log of a scene's [camera].
namespace airtruth::sequence {

// Reads a flight log of any format, also out of a GoPro's video. Errors as of read_flight_log().
flight_log::FlightLog read_log(const std::filesystem::path& path);

// The camera's path from its log, on the clip's clock. The position at the first frame is the
// stated one; without it the aircraft is over the origin at the log's height above take-off, or at
// the default height of a scene where the log states none. The attitude at the first frame is the
// stated one; without it it is the log's, and for a log without attitudes the aircraft is level and
// heads along its path. It is held, since the measured motion turns the camera from there; where
// follows_log_attitude is true it is the log's throughout.
//
// Throws Error where the log cannot be read, has a clock of its own and no log_offset_s, or does
// not cover the first frame.
trajectory::Path path_from_log(const scene::Camera& camera);

}  // namespace airtruth::sequence
