// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "foundation/geometry/box.h"
#include "runners/classical/scale_space.h"

// What the parts of a large object say of it. On the level of its size its bright and dark parts
// become one mean, and clouds of that size are its noise; on finer levels its wings, windows and
// edges respond, and the clouds do not.
namespace airtruth::classical {

// Parts are looked for on the levels that are at least this many octaves finer than the object's.
inline constexpr std::size_t kPartOctaves = 2;
// Root mean square of the largest response of a block, over the noise of the picture, in white
// noise on level 0 (blobs_test.cpp repeats it). The long elements of the others make it larger,
// which is on the safe side.
inline constexpr double kLargestOfBlock = 2.55;

struct Parts {
  // How much the responses in the box stand out of those around it: the root mean square of the
  // largest responses of the blocks in the box, over the noise that makes those of the ring of
  // blocks around it. The mean over the box tells an aircraft from a cloud that a bird is before.
  double to_noise = 0;
  // ln of the likelihood that the blocks in the box respond more than those around it, to that of
  // no difference, for normal numbers. It is the largest for the box that holds all parts and
  // little else.
  double log_ratio = 0;
};

// Of one level. Empty where the box is short enough to respond as a whole, and where too little of
// the ring lies in the picture.
std::optional<Parts> parts_within(const Level& level, const Box& box_px);

struct Whole {
  Box box_px;
  double to_noise = 0;  // the largest of the finer levels
};

// Of the boxes that an object of a level may have, the one with the largest likelihood, summed over
// the finer levels. Empty where no box has parts.
std::optional<Whole> whole_of_parts(const std::vector<Level>& levels,
                                    std::size_t level,
                                    const std::vector<Box>& boxes_px);

}  // namespace airtruth::classical
