// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "runners/tracking/tracker.h"
#include "runners/tracking/trax_message.h"

namespace airtruth::tracking {

// How pictures reach a tracker: as a PNG's path; as samples in the message, "image:W;H;rgb;BASE64";
// or as a PNG's bytes in the message, "data:image/png;BASE64".
enum class ImageKind { kPath, kMemory, kBuffer };

// A tracker's description of itself.
struct Hello {
  std::string name;
  int version = 1;
  ImageKind images = ImageKind::kPath;  // the first kind that the tracker names
  bool takes_rectangles = true;         // false: polygons, or else masks
  bool takes_polygons = false;
  // True for a tracker with a "vot" property, which cannot be started twice.
  bool is_for_one_run = false;
};

// Throws process::Failure for an unknown version or an unknown kind of pictures.
Hello hello_of(const Message& message);

// Makes a tracker that runs in its own process and speaks TraX, versions 1 to 4, from
// "trax:COMMAND" or "trax-socket:COMMAND"; returns nullptr for any other name. Every function of it
// throws process::Failure once the process crashes, misses a deadline, quits, or violates the
// protocol. The process is then over, and init() starts another.
std::unique_ptr<Tracker> make_trax_tracker(std::string_view name, const TrackerOptions& options);

// Returns the name that the tracker reports, made valid as a file name; "trax" where it reports
// none.
std::string trax_name(std::string_view name, const TrackerOptions& options);

}  // namespace airtruth::tracking
