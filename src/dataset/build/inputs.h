// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "dataset/build/build.h"
#include "dataset/catalogue/folder.h"
#include "foundation/base/files.h"
#include "picture/video/reader.h"

// What a catalogue needs on this machine: its backgrounds, aircraft and files.
namespace airtruth::build {

// Where the video and the mask of a virtual flight lie.
catalogue::BackgroundFiles files_of_flight(const catalogue::Background& background,
                                           const catalogue::Folder& folder);

// The SHA-256 of the lens file of a virtual flight: with the text of the catalogue it decides the
// flight. "" for a flight without one, and for a video.
std::string sha256_of_flight_lens(const catalogue::Background& background);

// Returns the files of a background: an existing video, or a virtual flight, which is made where it
// does not exist yet. A flight's files appear whole or not at all. Two processes that make the same
// flight at the same time write the same bytes. Throws Error for a flight that was made through
// another lens file.
catalogue::BackgroundFiles prepare(const catalogue::Background& background,
                                   const catalogue::Folder& folder,
                                   const BuildOptions& options);

// Takes the size, rate and length of a background's video.
void take_facts(const video::StreamInfo& info, catalogue::BackgroundFiles& files);

// BackgroundFiles::camera. Throws Error where the video or the camera's log cannot be read.
std::optional<scene::Camera> camera_with_log(const catalogue::Background& background,
                                             const fs::path& video);

// The size, rate and number of frames of a background: as its virtual flight states them, or as its
// video does. Throws Error where the video cannot be read, and where first_frame is past the end.
video::StreamInfo stream_of(const catalogue::Background& background);

// Checks the inputs of a catalogue on this machine before any work begins. Aircraft must be known
// and videos must exist. Each background's mask, lens, camera file and path must be readable and
// must fit its video and the catalogue's method. No two sequences may have the same name. Throws
// Error at the line of the catalogue.
void check_sources(const catalogue::Catalogue& catalogue);

// The catalogue with these videos, by the background's name, in place of its own; the masks of
// these backgrounds are left out, and the rate where it is no series of pictures. Throws Error for
// a background that the catalogue lacks.
catalogue::Catalogue with_videos(catalogue::Catalogue catalogue,
                                 const std::map<std::string, fs::path>& videos);

}  // namespace airtruth::build
