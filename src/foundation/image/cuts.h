// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "foundation/image/picture.h"

// Detects the cuts between the shots of a clip from the pictures alone. Code that links frames to
// one another (motion, blur, smoothing) links no frames across a cut.
namespace airtruth::image {

// The difference between a picture and the one before it: each picture is averaged over 32 x 24
// cells, and the difference is the mean absolute difference of luma over the cells, in code values.
class Differences {
 public:
  // The difference to the picture of the previous call; empty for the first picture.
  std::optional<double> add(const Picture& picture);

 private:
  std::vector<double> before_;
};

// The number of differences before and after a frame with which its own difference is compared.
inline constexpr int kCutNeighbours = 2;

// Whether a frame begins a shot: the one whose difference to the frame before is differences[here].
// It does where that is at least 6 code values and more than three times the difference of each
// neighbour, up to kCutNeighbours before and after as far as there are any. A pan or a change of
// exposure takes several frames and therefore does not count.
bool is_cut(std::span<const double> differences, std::size_t here);

}  // namespace airtruth::image
