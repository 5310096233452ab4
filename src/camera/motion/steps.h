// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "camera/motion/level_patch.h"
#include "camera/motion/levels.h"
#include "camera/motion/motion.h"

namespace airtruth::motion {

// The positions of a corner in two frames, in pixels of the picture (corner origin).
struct Step {
  Pixel from, to;
};

// The number of corners that are followed from one frame to the next.
constexpr std::size_t kMaxSteps = 150;

// The corners of one frame, to be found in the next. Where most of the picture moves as one, few
// corners on coarse levels tell where all are to be looked for; otherwise each one is followed by
// itself.
class Steps {
 public:
  // The corners to follow from now on, by their positions in this frame; at most kMaxSteps of them.
  void take(const Levels& levels, const std::vector<Pixel>& positions);
  std::size_t size() const { return corners_.size(); }

  // Few of the corners, from the coarsest level to the one whose pixels are good enough for a
  // guess.
  std::vector<Step> coarse(const Levels& now) const;
  // All corners on the finest level, each from a guess of its position, which may be empty.
  using Guess = std::function<std::optional<Pixel>(const Pixel&)>;
  std::vector<Step> fine(const Levels& now, const Guess& guess) const;
  // All corners, each by itself through the whole pyramid and back (corners.h), which costs several
  // times as much and holds where half of the picture moves by itself.
  std::vector<Step> alone(const Levels& now, const cv::Mat& allowed, const Options& options) const;

 private:
  std::optional<Step> follow(const Pixel& from, const Levels& now, int finest) const;

  Levels levels_;                    // of the corners' frame
  std::vector<LevelPatch> corners_;  // on the finest level
};

}  // namespace airtruth::motion
