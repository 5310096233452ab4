// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "camera/motion/follower.h"

// The model homography behind Estimator.
namespace airtruth::motion {

std::unique_ptr<Follower> planar_follower(const cv::Mat& allowed, const Options& options);

}  // namespace airtruth::motion
