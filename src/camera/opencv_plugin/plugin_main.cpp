// SPDX-License-Identifier: Apache-2.0
// The library itself, airtruth-late-opencv.so.
#include <opencv2/tracking.hpp>
#include <opencv2/tracking/tracking_legacy.hpp>

#include "camera/opencv_plugin/opencv_plugin.h"

namespace {

template <typename Kind, typename Base>
cv::Ptr<Base> made() {
  return Kind::create();
}

}  // namespace

extern "C" {
extern __attribute__((visibility("default")))
const airtruth::opencv_plugin::Functions airtruth_late_opencv __asm__(
    "airtruth_late_opencv_" AIRTRUTH_BUILD);
const airtruth::opencv_plugin::Functions airtruth_late_opencv = {
    .find_homography = &cv::findHomography,
    .estimate_affine_partial_2d = &cv::estimateAffinePartial2D,
    .build_optical_flow_pyramid = &cv::buildOpticalFlowPyramid,
    .calc_optical_flow_pyr_lk = &cv::calcOpticalFlowPyrLK,
    .mil = &made<cv::TrackerMIL, cv::Tracker>,
    .kcf = &made<cv::TrackerKCF, cv::Tracker>,
    .csrt = &made<cv::TrackerCSRT, cv::Tracker>,
    .boosting = &made<cv::legacy::TrackerBoosting, cv::legacy::Tracker>,
    .median_flow = &made<cv::legacy::TrackerMedianFlow, cv::legacy::Tracker>,
    .tld = &made<cv::legacy::TrackerTLD, cv::legacy::Tracker>,
    .mosse = &made<cv::legacy::TrackerMOSSE, cv::legacy::Tracker>,
    .init = [](cv::legacy::Tracker& tracker,
               cv::InputArray picture,
               const cv::Rect2d& box) { return tracker.init(picture, box); },
    .update = [](cv::legacy::Tracker& tracker,
                 cv::InputArray picture,
                 cv::Rect2d& box) { return tracker.update(picture, box); },
};
}
