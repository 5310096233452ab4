// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>

// Functions of OpenCV's modules calib3d, video and tracking. They stand in a library that is
// loaded at the first call (foundation/lazy_library/lazy_library.h), because these modules need
// more libraries, and more time to load, than all others of a render with known motion. The headers
// give types and constants alone. The parameters are OpenCV's, without default values.
namespace cv::legacy {
inline namespace tracking {
class Tracker;
}
}  // namespace cv::legacy

namespace airtruth::opencv_plugin {

struct Functions {
  // calib3d; one of several functions of this name
  cv::Mat (*find_homography)(cv::InputArray from,
                             cv::InputArray to,
                             int method,
                             double ransac_px,
                             cv::OutputArray mask,
                             int max_rounds,
                             double confidence);
  decltype(&cv::estimateAffinePartial2D) estimate_affine_partial_2d;
  // video
  decltype(&cv::buildOpticalFlowPyramid) build_optical_flow_pyramid;
  decltype(&cv::calcOpticalFlowPyrLK) calc_optical_flow_pyr_lk;
  // Trackers with their own defaults.
  cv::Ptr<cv::Tracker> (*mil)();
  cv::Ptr<cv::Tracker> (*kcf)();
  cv::Ptr<cv::Tracker> (*csrt)();
  cv::Ptr<cv::legacy::Tracker> (*boosting)();
  cv::Ptr<cv::legacy::Tracker> (*median_flow)();
  cv::Ptr<cv::legacy::Tracker> (*tld)();
  cv::Ptr<cv::legacy::Tracker> (*mosse)();
  bool (*init)(cv::legacy::Tracker& tracker, cv::InputArray picture, const cv::Rect2d& box);
  bool (*update)(cv::legacy::Tracker& tracker, cv::InputArray picture, cv::Rect2d& box);
};

// Throws Error where the library is not installed.
const Functions& functions();

// The library holds a Functions of this name (lazy_library::of_build()).
constexpr const char* kSymbol = "airtruth_late_opencv";

}  // namespace airtruth::opencv_plugin
