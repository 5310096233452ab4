// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"

// Single-object trackers: given an object's box in one frame, they say where it is in those that
// follow.
namespace airtruth::tracking {

struct Answer {
  Box box_px;             // docs/conventions.md
  double confidence = 1;  // as the tracker has it; of no common scale
  bool lost = false;      // the tracker itself says that it has lost the object; box_px is its last
  std::optional<double> seconds;  // that it took, where the tracker knows better than its caller
};

// A tracker is broken and gives no more answers: its process crashed, hung or broke the protocol.
class TrackerFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Tracker {
 public:
  virtual ~Tracker() = default;
  // Takes a frame in the form that this tracker works on (grey, RGB). Of what a run measures, this
  // is not the tracker's time.
  virtual void load(const image::Picture& picture) = 0;
  // On the loaded frame; a second call begins anew. Throws Error for a box that has no area or lies
  // outside the picture, and as update() does.
  virtual void init(const Box& box) = 0;
  virtual Answer update() = 0;                    // throws TrackerFailed
  virtual std::string log() const { return {}; }  // what its process said beside its answers
};

struct TrackerOptions {
  std::uint64_t seed = 1;  // of the trackers that are within the program: one seed, one result
  // Of a TraX tracker's process.
  double start_s = 30;   // longest until it is there
  double answer_s = 30;  // longest until each answer
  std::stop_token stop;
};

// "am3", "am3s", "wmil", "mil"; OpenCV's "opencv-mil", "opencv-kcf", "opencv-csrt",
// "opencv-boosting", "opencv-medianflow", "opencv-tld", "opencv-mosse"; "trax:COMMAND" for a
// program that speaks TraX on its standard input and output, "trax-socket:COMMAND" for one that
// connects to TRAX_SOCKET. Error with the nearest name otherwise; TrackerFailed where a command
// cannot be run or does not say hello.
std::unique_ptr<Tracker> make_tracker(std::string_view name, const TrackerOptions& options);
std::vector<std::string> tracker_names();
bool is_trax(std::string_view tracker);  // also with a name before it

// Under which results are kept: the name itself; of a TraX tracker what stands before "=" in
// "NAME=trax:COMMAND", else its own name for itself (for which it is started once). `command` is
// what make_tracker takes.
struct TrackerName {
  std::string name;
  std::string command;
  bool was_started = false;  // for its name, and ended well
};
TrackerName named(std::string_view tracker, const TrackerOptions& options);

}  // namespace airtruth::tracking
