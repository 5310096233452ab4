// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "foundation/geometry/box.h"
#include "runners/classical/scale_space.h"

// Isolated objects in a scale space, with their boxes and how they stand out.
namespace airtruth::classical {

struct Blob {
  Box box_px;
  // How much the object's strongest sample stands out of what is around it, in the level's smoothed
  // picture: the larger of two measures. One is its contrast to the ring over the noise of the
  // ring. The other is its response over the noise of the responses there and the clutter (their
  // root sum of squares).
  double contrast_to_noise = 0;
  // The first of the two alone: of several boxes of an object, that of the largest is the best. 0
  // where the ring does not bound it.
  double against_ring = 0;
  std::size_t level = 0;  // on which it was found
  cv::Point sample;       // of its strongest response, on that level
};

// The blob at a sample of a level. Its surroundings are a square ring; a plane is fitted to them,
// so that a slope of the sky is neither contrast nor noise, and the noise follows from the absolute
// deviations from it: it is their standard deviation where they are normal. The box bounds the
// connected samples of the next finer level that differ from the surroundings, to either side, by a
// tenth of the contrast where the noise allows it and they end somewhere, else by three tenths; it
// is that of the object before the level's smoothing (region.h). Empty where they reach too far:
// the object is larger than the level's, or part of something else.
std::optional<Blob> blob_at(const std::vector<Level>& levels,
                            std::size_t level,
                            const cv::Point& sample);

// The blobs of all levels whose response is the strongest of a block and of the blocks around it.
// The strongest first.
struct BlobOptions {
  // In units of the typical response.
  double least_response = kIsolated;
  // The blocks with the strongest relative responses are looked at.
  std::size_t most_of_a_level = 150;
};
std::vector<Blob> blobs_of(const std::vector<Level>& levels, const BlobOptions& options);

// True where both boxes are of one object: the smaller one lies by half within the other.
bool is_same_object(const Box& a, const Box& b);

// What the parts of a large object say of it. On the level of its size its bright and dark parts
// become one mean, and clouds of that size are its noise; on finer levels its wings, windows and
// edges respond, and the clouds do not.

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
