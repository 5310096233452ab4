// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "motion/motion.h"
#include "synthetic/flight.h"

// Measured motion against motion that is known: a pinhole that only turns, so that a homography is
// exact, the own aircraft in view, a fifth of the picture wandering by itself.
namespace airtruth::synthetic {
namespace {

constexpr int kFrames = 1000;

// Mean distance over the image's corners between where two homographies take them.
double corner_error_px(const Homography& measured,
                       const Homography& truth,
                       double width,
                       double height) {
  double sum = 0;
  for (const Pixel& corner : {Pixel(0, 0), Pixel(width, 0), Pixel(0, height), Pixel(width, height)})
    sum += (apply(measured, corner) - apply(truth, corner)).norm();
  return sum / 4;
}

TEST(MotionYardstick, FrameToFrameErrorAtTheCornersIsBelowAThirdOfAPixel) {
  FlightOptions options;
  options.width = 640;
  options.height = 480;
  options.frame_count = kFrames;
  options.clutter = 0.2;
  options.translate = false;
  const Flight flight(options);
  motion::Estimator estimator(options.width, options.height, {}, &flight.own_aircraft());
  std::vector<double> between_frames;
  Homography measured_before = Homography::Identity();
  Homography truth_before = Homography::Identity();
  for (int k = 0; k < kFrames; ++k) {
    const double time_s = k / options.frame_rate_hz;
    const Homography measured = estimator.next(flight.frame(k), time_s).frame_from_reference;
    const Homography truth = flight.frame_from_first(k);
    if (k > 0)
      between_frames.push_back(corner_error_px(measured * measured_before.inverse(),
                                               truth * truth_before.inverse(),
                                               options.width,
                                               options.height));
    measured_before = measured;
    truth_before = truth;
    if (k == 10 || k == 100 || k == 300 || k == kFrames - 1)
      std::printf("against the first frame at %4d: %.2f px\n",
                  k,
                  corner_error_px(measured, truth, options.width, options.height));
  }
  std::sort(between_frames.begin(), between_frames.end());
  const double median = between_frames[between_frames.size() / 2];
  std::printf("frame to frame: median %.3f px, 95 %% below %.3f px\n",
              median,
              between_frames[between_frames.size() * 95 / 100]);
  EXPECT_LT(median, 0.3);
}

}  // namespace
}  // namespace airtruth::synthetic
