// SPDX-License-Identifier: Apache-2.0
#include "calibration/own_aircraft/stillness.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace airtruth::own_aircraft {
namespace {

// Distances between the frames of a pair, in kept frames: slow and fast motion are both covered.
constexpr std::array<std::size_t, 3> kPairDistances{1, 3, 7};
// Largest motion between the frames of a pair, as a share of the width: beyond it, too little of
// the world is in both.
constexpr double kMaxPairMotionShare = 0.25;
// Bound of a difference, code values, so that a few strong edges do not decide a mean.
constexpr double kMaxDifference = 40;
// A pixel that never exceeds this value is black, code values: a choice.
constexpr float kBlack = 10;
// Standard deviation of the blur of the mean differences, working pixels.
constexpr double kDifferenceBlurPx = 1;
// Noise of the differences: the quantile 1 / kNoiseQuantile, with a least value in code values.
constexpr std::size_t kNoiseQuantile = 10;
constexpr float kMinNoise = 0.6F;
// Ratios between the two differences, beyond the noise, from which on a pixel is certainly
// aircraft, certainly world, or probably aircraft. They were chosen on the virtual flights of
// surroundings_slow_test.cpp.
constexpr float kCertainAircraft = 1.8F, kCertainWorld = 1.3F, kProbableAircraft = 1.2F;
// Share of the noise by which a probable pixel differs.
constexpr float kProbableNoise = 0.3F;

// The homography between two kept frames at the working size, in OpenCV's pixels with integer
// centres.
cv::Matx33d small_step(const KeptFrame& to, const KeptFrame& from, double scale) {
  Homography down = Homography::Identity();
  down(0, 0) = down(1, 1) = scale;
  down(0, 2) = down(1, 2) = -0.5;
  const Homography h = down * to.from_reference * from.from_reference.inverse() * down.inverse();
  return {h(0, 0), h(0, 1), h(0, 2), h(1, 0), h(1, 1), h(1, 2), h(2, 0), h(2, 1), h(2, 2)};
}

double mean_motion_px(const cv::Matx33d& h, const cv::Size& size) {
  double sum = 0;
  int count = 0;
  for (int y = 1; y < 4; ++y)
    for (int x = 1; x < 4; ++x) {
      const cv::Vec3d p(size.width * x / 4.0, size.height * y / 4.0, 1);
      const cv::Vec3d q = h * p;
      sum += std::hypot(q[0] / q[2] - p[0], q[1] / q[2] - p[1]);
      ++count;
    }
  return sum / count;
}

// Adds the differences of one pair. Only places that both frames show count.
void add_pair(const cv::Mat& to,
              const cv::Mat& from,
              const cv::Matx33d& step,
              Stillness& sums,
              cv::Mat& count) {
  const cv::Size size = from.size();
  cv::Mat there, inside;
  cv::warpPerspective(to, there, step, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);
  cv::warpPerspective(
      cv::Mat::ones(size, CV_32F), inside, step, size, cv::INTER_NEAREST | cv::WARP_INVERSE_MAP);
  cv::Mat still, moving;
  cv::absdiff(to, from, still);
  cv::absdiff(there, from, moving);
  cv::min(still, kMaxDifference, still);
  cv::min(moving, kMaxDifference, moving);
  sums.still += still.mul(inside);
  sums.moving += moving.mul(inside);
  count += inside;
  ++sums.pairs;
}

// The noise of the clip: the lower tenth of the differences at the same place.
float noise_of(const cv::Mat& still) {
  std::vector<float> values(still.begin<float>(), still.end<float>());
  const std::size_t tenth = values.size() / kNoiseQuantile;
  std::nth_element(
      values.begin(), values.begin() + static_cast<std::ptrdiff_t>(tenth), values.end());
  return std::max(kMinNoise, values[tenth]);
}

}  // namespace

Stillness stillness_of(const std::vector<KeptFrame>& frames, double scale) {
  const cv::Size size = frames[0].grey.size();
  Stillness sums{
      cv::Mat::zeros(size, CV_32F), cv::Mat::zeros(size, CV_32F), cv::Mat::zeros(size, CV_32F), 0};
  cv::Mat count = cv::Mat::zeros(size, CV_32F);
  for (const KeptFrame& frame : frames) cv::max(sums.brightest, frame.grey, sums.brightest);
  for (std::size_t i = 0; i < frames.size(); ++i)
    for (const std::size_t distance : kPairDistances) {
      if (i + distance >= frames.size()) continue;
      const cv::Matx33d step = small_step(frames[i + distance], frames[i], scale);
      const double moved_px = mean_motion_px(step, size);
      if (moved_px < kMinPairMotionPx || moved_px > kMaxPairMotionShare * size.width) continue;
      add_pair(frames[i + distance].grey, frames[i].grey, step, sums, count);
    }
  cv::max(count, 1e-3, count);
  sums.still /= count;
  sums.moving /= count;
  return sums;
}

cv::Mat labels_by_stillness(const Stillness& pairs) {
  const float noise = noise_of(pairs.still);
  cv::Mat labels(pairs.still.size(), CV_8UC1, cv::Scalar(cv::GC_PR_BGD));
  cv::Mat still, moving;
  cv::GaussianBlur(pairs.still, still, {}, kDifferenceBlurPx);
  cv::GaussianBlur(pairs.moving, moving, {}, kDifferenceBlurPx);
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x) {
      const float s = still.at<float>(y, x);
      const float m = moving.at<float>(y, x);
      unsigned char& label = labels.at<unsigned char>(y, x);
      if (pairs.brightest.at<float>(y, x) < kBlack || m > kCertainAircraft * s + noise)
        label = cv::GC_FGD;
      else if (s > kCertainWorld * m + noise)
        label = cv::GC_BGD;
      else if (m > kProbableAircraft * s + kProbableNoise * noise)
        label = cv::GC_PR_FGD;
    }
  return labels;
}

}  // namespace airtruth::own_aircraft
