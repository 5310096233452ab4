// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include <opencv2/core.hpp>

#include "camera/motion/motion.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

// Selects corners and tracks them from one picture to another, for both models of motion. All
// positions are OpenCV's integer-centred pixels.
namespace airtruth::motion {

using Pyramid = std::vector<cv::Mat>;

cv::Mat luma_of(const image::Picture& picture);  // shares the samples
Pyramid pyramid_of(const cv::Mat& grey);

// A mask that is 255 where corners are allowed, which is at a distance from the own aircraft.
cv::Mat allowed_area(int width, int height, const image::Mask* own_aircraft);

// The strongest corners of each cell of the picture, so that no single cloud receives all corners.
// Where is_far is given, up to half of the corners are far ones. Far corners may lie closer
// together, because the strip along the horizon has few cells.
std::vector<cv::Point2f> spread_corners(const cv::Mat& grey,
                                        const cv::Mat& allowed,
                                        const Options& options,
                                        const std::function<bool(const cv::Point2f&)>& is_far = {});

// Tracks corners by pyramidal Lucas-Kanade, and tracks them back as a check. On entry `moved` holds
// a guess of each position (used when `guessed`); on return it holds the positions found. The
// result states which corners were found inside the allowed area and returned to within
// options.forward_backward_px.
std::vector<bool> follow(const Pyramid& from,
                         const Pyramid& to,
                         const cv::Mat& allowed,
                         const std::vector<cv::Point2f>& corners,
                         std::vector<cv::Point2f>& moved,
                         bool guessed,
                         const Options& options);

}  // namespace airtruth::motion
