// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "camera/motion/motion.h"

namespace airtruth::motion {

// The map from a key frame to a later frame, with its inliers among the corners.
struct ModelFit {
  Homography frame_from_key = Homography::Identity();  // OpenCV's integer-centred pixels
  std::vector<bool> is_inlier;
  int inliers = 0;
  double rms_px = 0;
};

// Fits the plane map from the corners `key` to their positions `moved`: RANSAC (Fischler and Bolles
// 1981), then least squares on the inliers (Levenberg-Marquardt). Both vectors have the same size,
// and all positions are OpenCV's integer-centred pixels. The fit is a homography where the hull of
// the inliers covers enough of the image (the square root of its share of the area is at least
// 0.35). Otherwise, for example with clouds along a horizon, it is a similarity, since a homography
// from a thin band of points extrapolates badly. The result is empty where there are fewer than
// options.min_inliers inliers, or where the map is no motion that a camera makes between two key
// frames.
std::optional<ModelFit> fit_model(const std::vector<cv::Point2f>& key,
                                  const std::vector<cv::Point2f>& moved,
                                  cv::Size image,
                                  const Options& options);

}  // namespace airtruth::motion
