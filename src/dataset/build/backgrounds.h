// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dataset/build/build.h"
#include "dataset/catalogue/folder.h"
#include "picture/video/reader.h"

namespace airtruth::build {

// Returns the files of a background: an existing video, or a virtual flight, which is made where it
// does not exist yet. A flight's files appear whole or not at all. Two processes that make the same
// flight at the same time write the same bytes.
catalogue::BackgroundFiles prepare(const catalogue::Background& background,
                                   const catalogue::Folder& folder,
                                   const BuildOptions& options);

// Throws Error where the video or the camera's log cannot be read.
catalogue::LogStart log_start(const catalogue::Background& background, const fs::path& video);

// The size, rate and number of frames of a background: as its virtual flight states them, or as its
// video does. Throws Error where the video cannot be read.
video::StreamInfo stream_of(const catalogue::Background& background);

}  // namespace airtruth::build
