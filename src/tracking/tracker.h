// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/box.h"
#include "image/picture.h"

// Single-object trackers: given an object's box in one frame, they say where it is in those that
// follow.
namespace airtruth::tracking {

struct Answer {
  Box box_px;             // docs/conventions.md
  double confidence = 1;  // as the tracker has it; of no common scale
  bool lost = false;      // the tracker itself says that it has lost the object; box_px is its last
};

class Tracker {
 public:
  virtual ~Tracker() = default;
  // Takes a frame in the form that this tracker works on (grey, RGB). Of what a run measures, this
  // is not the tracker's time.
  virtual void load(const image::Picture& picture) = 0;
  // On the loaded frame. Throws Error for a box that has no area or lies outside the picture.
  virtual void init(const Box& box) = 0;
  virtual Answer update() = 0;
};

// "am3", "wmil", "mil"; OpenCV's "opencv-mil", "opencv-kcf", "opencv-csrt", "opencv-boosting",
// "opencv-medianflow", "opencv-tld", "opencv-mosse". Error with the nearest name otherwise. One
// seed, one result.
std::unique_ptr<Tracker> make_tracker(std::string_view name, std::uint64_t seed);
std::vector<std::string> tracker_names();

}  // namespace airtruth::tracking
