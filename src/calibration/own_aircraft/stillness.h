// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "calibration/own_aircraft/kept_frames.h"

// What pairs of frames say about each pixel: whether it stays still, or moves with the world.
namespace airtruth::own_aircraft {

// Least motion between the frames of a pair, px at the working size. With less, both hypotheses fit
// the edges of either.
inline constexpr double kMinPairMotionPx = 2;

// At the working size; differences are in code values.
struct Stillness {
  // Mean difference between the frames of a pair at the same place.
  cv::Mat still;
  // Mean difference between a place and the place to which the world moved.
  cv::Mat moving;
  // The greatest value of each pixel over all frames.
  cv::Mat brightest;
  // The number of pairs between which the world moved far enough.
  int pairs = 0;
};

Stillness stillness_of(const std::vector<KeptFrame>& frames, double scale);

// A first decision for each pixel, in the labels of GrabCut: certain (GC_FGD: the aircraft, GC_BGD:
// the world) or probable (GC_PR_FGD, GC_PR_BGD).
cv::Mat labels_by_stillness(const Stillness& pairs);

}  // namespace airtruth::own_aircraft
