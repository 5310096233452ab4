// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include <opencv2/core.hpp>

#include "camera/motion/motion.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

// Corners and their way from one picture to another, for both models of motion. OpenCV's
// integer-centred pixels throughout.
namespace airtruth::motion {

using Pyramid = std::vector<cv::Mat>;

cv::Mat luma_of(const image::Picture& picture);  // shares the samples
Pyramid pyramid_of(const cv::Mat& grey);

// 255 where corners may be: away from the own aircraft.
cv::Mat allowed_area(int width, int height, const image::Mask* own_aircraft);

// The best corners of each cell of the picture, so that no one cloud takes them all. Where is_far
// says what is far, up to half of them are far ones, which lie closer together: a strip along the
// horizon has few cells.
std::vector<cv::Point2f> spread_corners(const cv::Mat& grey,
                                        const cv::Mat& allowed,
                                        const Options& options,
                                        const std::function<bool(const cv::Point2f&)>& is_far = {});

// Pyramidal Lucas-Kanade forth, and back as a check. moved: in, where each may be (used when
// `guessed`); out, where it was found. Returns which were found, inside the allowed area, and came
// back to within options.forward_backward_px.
std::vector<bool> follow(const Pyramid& from,
                         const Pyramid& to,
                         const cv::Mat& allowed,
                         const std::vector<cv::Point2f>& corners,
                         std::vector<cv::Point2f>& moved,
                         bool guessed,
                         const Options& options);

}  // namespace airtruth::motion
