// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

// Functions of OpenCV's modules calib3d, video and tracking. They stand in a library that is
// loaded at the first call (foundation/lazy_library/lazy_library.h), because these modules need
// more libraries, and more time to load, than all others of a render with known motion. The
// parameters are OpenCV's, without default values.
namespace cv {
class Tracker;
namespace legacy {
inline namespace tracking {
class Tracker;
}
}  // namespace legacy
}  // namespace cv

namespace airtruth::opencv_plugin {

struct Functions {
  // calib3d
  cv::Mat (*find_homography)(cv::InputArray from,
                             cv::InputArray to,
                             int method,
                             double ransac_px,
                             cv::OutputArray mask,
                             int max_rounds,
                             double confidence);
  cv::Mat (*estimate_affine_partial_2d)(cv::InputArray from,
                                        cv::InputArray to,
                                        cv::OutputArray inliers,
                                        int method,
                                        double ransac_px,
                                        std::size_t max_rounds,
                                        double confidence,
                                        std::size_t refinements);
  // video
  int (*build_optical_flow_pyramid)(cv::InputArray picture,
                                    cv::OutputArrayOfArrays pyramid,
                                    cv::Size window,
                                    int max_level,
                                    bool with_derivatives,
                                    int border,
                                    int border_of_derivatives,
                                    bool reuses_picture);
  void (*calc_optical_flow_pyr_lk)(cv::InputArray from,
                                   cv::InputArray to,
                                   cv::InputArray points,
                                   cv::InputOutputArray moved,
                                   cv::OutputArray status,
                                   cv::OutputArray error,
                                   cv::Size window,
                                   int max_level,
                                   cv::TermCriteria enough,
                                   int flags,
                                   double min_eigenvalue);
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
