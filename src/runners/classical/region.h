// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include <opencv2/core.hpp>

#include "foundation/geometry/box.h"
#include "runners/classical/scale_space.h"

// The connected samples of an object, and the box that it has without the smoothing of its level.
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

}  // namespace airtruth::classical
