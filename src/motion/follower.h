// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "lens/lens.h"
#include "motion/motion.h"

// The two models of motion behind Estimator.
namespace airtruth::motion {

constexpr int kPatience = 15;  // bridged frames in a row before tracking starts anew
constexpr double kCutShare =
    0.12;  // fewer survivors than this between two textured frames: the scene changed

class Follower {
 public:
  virtual ~Follower() = default;
  virtual FrameMotion next(const cv::Mat& grey, bool damaged) = 0;
  // How far the rotation may have strayed from the truth since the frame before, as a standard
  // deviation: where a key frame was tied to others, and where tracking began anew.
  virtual double stray_rad() const { return 0; }
};

std::unique_ptr<Follower> planar_follower(const cv::Mat& allowed, const Options& options);
std::unique_ptr<Follower> spherical_follower(const lens::Lens& lens,
                                             const cv::Mat& allowed,
                                             const Options& options);

}  // namespace airtruth::motion
