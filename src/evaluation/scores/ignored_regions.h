// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <airtruth/box.h>

#include "foundation/base/files.h"

// Regions in which detections count neither way, as for real aircraft of a background that nobody
// labelled. A CSV file with the heading
//   sequence,first_frame,last_frame,x,y,width,height
// states one region a line, in pixels; the first pixel covers [0, 1). `sequence` is the name of a
// sequence, in which * and ? may stand for others, or the file name of a background video; frames
// are those of that video, from 0, the last one included. Without first_frame the region begins
// with the first frame, without last_frame it ends with the last one. Lines that begin with # are
// passed over.
//
// Example: an airliner crosses the upper part of one background from frame 300 to 420.
//   sequence,first_frame,last_frame,x,y,width,height
//   cumulus_a4.mp4,300,420,850,40,200,60
namespace airtruth::scores {

struct IgnoredRegion {
  std::string sequence;
  std::int64_t first_frame = 0;
  std::optional<std::int64_t> last_frame;
  Box box_px;
  int line = 0;  // of the file
};

// Throws Error with file and line.
std::vector<IgnoredRegion> read_ignored_regions(const fs::path& file);

}  // namespace airtruth::scores
