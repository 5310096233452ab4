// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "camera/motion/levels.h"
#include "camera/motion/patch.h"
#include "foundation/geometry/transform.h"

namespace airtruth::motion {

// A patch of one level of a picture. Its positions are those of its middle, in pixels of the
// picture (corner origin).
class LevelPatch {
 public:
  // The patch around the whole sample nearest to a position. On a coarse level a patch at the rim
  // is moved inward, so that its middle is elsewhere. Empty where Patch::at() is.
  static std::optional<LevelPatch> around(const Levels& levels, int level, const Pixel& position);

  Pixel middle() const;
  // The position in another picture, from a guess. Empty where nothing similar is found.
  std::optional<Pixel> find(const Levels& levels, const Pixel& guess) const;

 private:
  LevelPatch(int level, const cv::Point& first, const Patch& patch)
      : level_(level), first_(first), patch_(patch) {}
  int level_;
  cv::Point first_;  // sample of the patch
  Patch patch_;
};

}  // namespace airtruth::motion
