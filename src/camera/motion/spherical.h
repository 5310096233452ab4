// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "camera/lens/lens.h"
#include "camera/motion/follower.h"

// The model rotation behind Estimator.
namespace airtruth::motion {

std::unique_ptr<Follower> spherical_follower(const lens::Lens& lens,
                                             const cv::Mat& allowed,
                                             const Options& options);

}  // namespace airtruth::motion
