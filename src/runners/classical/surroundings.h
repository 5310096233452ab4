// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "runners/classical/scale_space.h"

// What an object is seen against: the ring of samples around it.
namespace airtruth::classical {

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
