// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"
#include "runners/process/child.h"

// Single-object trackers: a tracker receives the box of an object in one frame and reports its box
// in the following frames.
//
// Example: an object of 20 x 8 px has its top-left corner at (100, 50) and moves right by 3 px per
// frame. The caller loads the first frame, calls init() with that box, loads the second frame and
// calls update(). A perfect tracker returns a box of 20 x 8 px with its corner at (103, 50). If the
// tracker returns (101, 50) instead, the boxes share 18 x 8 = 144 px of a union of 176 px, an
// overlap of 0.82.
namespace airtruth::tracking {

struct Answer {
  // In pixels (docs/conventions.md).
  Box box_px;
  // True where the tracker reports that it has lost the object; box_px is then its last box.
  bool lost = false;
  // Time for this answer in seconds, where the tracker measures it better than its caller.
  std::optional<double> seconds;
  // True where it is lost because it reports a box with a width or height below 0.
  bool has_negative_side = false;
};

class Tracker {
 public:
  virtual ~Tracker() = default;
  // Converts a frame to the form that this tracker needs (grey, RGB). This time does not count as
  // the tracker's. Throws process::Failure as update() does.
  virtual void load(const image::Picture& picture) = 0;
  // Starts the tracker on the loaded frame; a second call starts it anew. Throws Error for a box
  // that has no area or lies outside the picture, and process::Failure as update() does.
  virtual void init(const Box& box) = 0;
  // Finds the object in the loaded frame. Throws process::Failure.
  virtual Answer update() = 0;
  // Output of the tracker's process other than its answers.
  virtual std::string log() const { return {}; }
};

// Throws Error for a box that has no area within a picture of this size: no tracker can begin
// there.
void refuse_unsound(const Box& box, int width, int height);

// The limits are for the process of a TraX tracker.
struct TrackerOptions : process::Limits {
  // Seed of the built-in trackers; the same seed gives the same result.
  std::uint64_t seed = 1;
};

// Makes a tracker by name: "am3", "am3s", "wmil", "mil"; OpenCV's "opencv-mil", "opencv-kcf",
// "opencv-csrt", "opencv-boosting", "opencv-medianflow", "opencv-tld", "opencv-mosse";
// "trax:COMMAND" for a program that speaks TraX on its standard input and output;
// "trax-socket:COMMAND" for one that connects to TRAX_SOCKET. Throws Error with the nearest name
// for any other name, and process::Failure where a command cannot be run or does not send TraX's
// hello message.
std::unique_ptr<Tracker> make_tracker(std::string_view name, const TrackerOptions& options);
// Makes "am3"; "am3s", which follows the scale by optical flow and whose classifiers start anew
// whenever the scale has changed by half; and the trackers of Babenko et al. ("mil") and of Zhang
// and Song ("wmil"), one classifier at one resolution. Returns nullptr for any other name.
std::unique_ptr<Tracker> make_am3(std::string_view name, std::uint64_t seed);
// One of OpenCV's alone, which need no model file; nullptr for any other name. Each tracker gets
// newly seeded random numbers.
std::unique_ptr<Tracker> make_opencv_tracker(std::string_view name, std::uint64_t seed);
std::vector<std::string> tracker_names();
bool is_trax(std::string_view tracker);  // also for "NAME=trax:COMMAND"

// The name under which results are stored. It is the tracker's name itself; for a TraX tracker it
// is the text before "=" in "NAME=trax:COMMAND", or else the name that the tracker reports (it is
// started once to report it). `command` is the argument for make_tracker().
struct TrackerName {
  std::string name;
  std::string command;
  bool was_started = false;  // started to report its name, and ended normally
};
TrackerName named(std::string_view tracker, const TrackerOptions& options);

}  // namespace airtruth::tracking
