// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace airtruth::motion {

// A picture at half, quarter, ... of its size. Level 0 shares the samples of the picture. A sample
// of level n + 1 is the mean of two by two samples of level n, so a position p in pixels of the
// picture (corner origin) is p / 2^n in samples of level n.
using Levels = std::vector<cv::Mat>;
Levels levels_of(const cv::Mat& grey);

}  // namespace airtruth::motion
