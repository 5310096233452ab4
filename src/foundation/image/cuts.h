// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "foundation/image/picture.h"

// Where one shot of a clip ends and another begins, from pictures alone. Whoever links frames to
// one another (motion, blur, smoothing) links none across a cut.
namespace airtruth::image {

// How far a picture differs from the one before: the mean absolute difference of luma, code values,
// each picture averaged over 32 x 24 cells.
class Differences {
 public:
  // Empty for the first picture.
  std::optional<double> add(const Picture& picture);

 private:
  std::vector<double> before_;
};

// Differences to the left and right of a frame's own that its own is held against.
inline constexpr int kCutNeighbours = 2;

// Does a frame that differs by `here` from the one before begin a shot? It does where that is 6
// code values or more, and more than three times what any of its neighbours (up to kCutNeighbours
// before it and after it) differs by: a pan or a change of exposure takes several frames.
bool is_cut(std::span<const double> before, double here, std::span<const double> after);

}  // namespace airtruth::image
