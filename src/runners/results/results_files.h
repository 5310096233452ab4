// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "foundation/base/error.h"
#include "runners/results/results_folder.h"

// The parts of results_folder.h; only this module includes it.
namespace airtruth::results {

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

// MOTChallenge text. Throws Error.
void read_mot_text(const fs::path& file, FrameList& frames);
std::string mot_text_of(const SequenceDetections& detections);

// COCO results. Throws Error.
std::vector<SequenceDetections> read_coco_results(const fs::path& file,
                                                  std::span<const ExpectedSequence> set);

// To 1/1000 px: what is written and read back is written again as the same text.
double rounded_px(double coordinate_px);

}  // namespace airtruth::results
