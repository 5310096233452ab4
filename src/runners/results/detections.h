// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <airtruth/box.h>

#include "foundation/base/error.h"

// What a detector reports: boxes with scores.
//
// Example: a detector sees one aircraft at (100, 50) with 20 x 8 px in the first of two frames and
// nothing in the second. Its sequence has frames = {{{{100, 50, 20, 8}, 7.5, "aircraft", {}}}, {}}.
namespace airtruth::results {

struct Detection {
  // The first pixel covers [0, 1); docs/conventions.md.
  Box box_px;
  // Finite. A higher score means more confidence; detectors have no common scale.
  double score = 0;
  std::string category = "aircraft";
  // The same number for the same object throughout a sequence; empty where the detector, or the
  // association after it, has declared no track here.
  std::optional<std::int64_t> track;

  bool operator==(const Detection&) const = default;
};

// The highest score first; equal ones stay in their order.
void sort_by_score(std::vector<Detection>& detections);

// The detections of a sequence.
struct SequenceDetections {
  std::string name;  // of the sequence, or of the video
  int width = 0;     // of its pictures, px
  int height = 0;
  // One list for each frame of the sequence, in order; an empty list where nothing was detected.
  std::vector<std::vector<Detection>> frames;
  // The detector's own time for each frame, in seconds; empty where it is unknown.
  std::vector<double> seconds;
  // Path of the video or the pictures that were named alone; "": it is a sequence of a set.
  std::string source = {};
  // The rate of pictures, frames a second, where the call that made these stated one.
  std::optional<double> stated_rate_hz = {};
  // SHA-256 that names the content of the sequence or of the video; "": unknown.
  std::string source_sha256 = {};
};

// True for a box of finite numbers that has an area.
bool is_sound(const Box& box);

// What makes a detection impossible in a picture of this size (0: unknown), as the first half of a
// message; empty where it is possible. A box must have an area and touch the picture; its numbers
// and the score must be finite.
//
//   fault_of({{700, 0, 9, 9}, 1}, 640, 480) == "the box 700,0 9x9 lies outside its image of
//   640x480"
std::optional<std::string> fault_of(const Detection& detection, int width, int height);

// Frames of a sequence as they are read.
class FrameList {
 public:
  // Frames beyond `frames` are an error; 0: the number is unknown, and the list grows.
  FrameList(std::string name, int width, int height, std::int64_t frames);
  // `frame` counts from 0. Throws Error at `where`.
  void add(std::int64_t frame, Detection detection, const Where& where);
  SequenceDetections take() { return std::move(found_); }

 private:
  SequenceDetections found_;
  bool grows_ = false;
};

}  // namespace airtruth::results
