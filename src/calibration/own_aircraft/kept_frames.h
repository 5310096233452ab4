// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "calibration/own_aircraft/own_aircraft.h"
#include "foundation/geometry/transform.h"
#include "picture/video/reader.h"

// The frames of a clip from which the mask of the own aircraft is found.
namespace airtruth::own_aircraft {

// Number of frames that are kept of a clip, spread over it: at least half as many, at most twice as
// many, since the length of a clip is an estimate. It bounds memory: a kept frame takes 1 MB at the
// working size.
inline constexpr int kKeptFrames = 48;

struct KeptFrame {
  // Luma at the working size, slightly blurred, float.
  cv::Mat grey;
  // In pixels of the full-size picture.
  Homography from_reference = Homography::Identity();
};

// Sums over the kept frames at full size.
struct FrameSums {
  cv::Mat rgb, squares;  // float; squares of grey
  int count = 0;

  void add(const cv::Mat& frame);
  // Standard deviation of grey over time, code values.
  cv::Mat spread() const;
  // The picture for GrabCut. Its channels are the mean grey, the standard deviation of grey over
  // time, and the difference between blue and red.
  cv::Mat features() const;
};

struct KeptFrames {
  std::vector<KeptFrame> frames;
  FrameSums sums;
};

// Reads the video to its end and keeps every n-th frame, reduced by `scale`, with the motion of the
// world. Throws Interrupted if options.stop asks for it.
KeptFrames keep_frames(video::Reader& reader, const MaskOptions& options, double scale);

}  // namespace airtruth::own_aircraft
