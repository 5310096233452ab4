// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include <opencv2/core.hpp>

#include "foundation/geometry/box.h"
#include "runners/classical/scale_space.h"

// The connected samples of an object, the box that it has without the smoothing of its level, and
// the ring of samples around it.
namespace airtruth::classical {

// Samples this far apart belong together: between a lit and a shaded part lies one that looks like
// the sky.
inline constexpr int kGap = 2;

struct Region {
  cv::Rect samples;
  // Where the excess falls below the least one, interpolated between samples, whose own positions
  // are whole numbers.
  double left = 0, top = 0, right = 0, bottom = 0;
  // The least excess over the region's largest.
  double share = 0;
};

// How much a sample of a level differs from its surroundings.
using Excess = std::function<double(const cv::Point& sample)>;

// The connected samples around a seed whose excess is at least `least`; empty where they reach
// beyond `reach` samples from the seed.
std::optional<Region> region_around(
    const Level& level, const cv::Point& seed, int reach, const Excess& excess, double least);

// The side of a uniform bar that, blurred by a Gaussian of this standard deviation, falls to this
// share of its middle's excess `half_px` away from the middle:
// (F((half + side / 2) / sigma) - F((half - side / 2) / sigma)) / (2 F(side / 2 / sigma) - 1) =
// share, with the normal distribution's F. 0 where a point reaches further.
double side_before_blur(double half_px, double share, double sigma_px);

// The box of a region in the picture, without the blur of its level.
Box box_of(const Region& region, const Level& level);

// What an object is seen against: the ring of samples around it.
// v(x, y) = middle + x * along_x + y * along_y around a sample, in units of the level's picture.
struct Surroundings {
  double middle = 0, along_x = 0, along_y = 0;
  double noise = 0;
  double at(double x, double y) const { return middle + along_x * x + along_y * y; }
};

// The plane's slope is by least squares and its height by the median, which other objects in the
// ring do not lift. Samples within `object` do not count; of the others, every `stride`-th of every
// `stride`-th row.
// Empty where too few samples of the ring lie in the picture.
std::optional<Surroundings> surroundings_of(const Level& level,
                                            const cv::Point& centre,
                                            const cv::Rect& object,
                                            int stride);

// The noise of the level's picture that makes responses as large as those in the same ring: the
// larger of what their median and their 90 % quantile say. Empty where too few samples lie in the
// picture.
std::optional<double> noise_of_responses(const Level& level,
                                         const cv::Point& centre,
                                         const cv::Rect& object);

}  // namespace airtruth::classical
