// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "camera/motion/motion.h"

namespace airtruth::motion {

struct ModelFit {
  Homography frame_from_key = Homography::Identity();  // OpenCV's integer-centred pixels
  std::vector<bool> is_inlier;
  int inliers = 0;
  double rms_px = 0;
};

// The plane motion that carries `key` to `moved`: RANSAC, refined on its inliers by least squares
// (Levenberg-Marquardt). A homography where the inliers span the image; where they lie in a part of
// it (clouds along a horizon), a similarity inside that part's evidence, since a homography
// extrapolated from a thin band runs wild. Empty where there are too few inliers, or where the
// result is no motion that a camera makes between two key frames.
std::optional<ModelFit> fit_model(const std::vector<cv::Point2f>& key,
                                  const std::vector<cv::Point2f>& moved,
                                  cv::Size image,
                                  const Options& options);

}  // namespace airtruth::motion
