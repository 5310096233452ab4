// SPDX-License-Identifier: Apache-2.0
#include "calibration/own_aircraft/aircraft_region.h"

#include <algorithm>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "foundation/base/median.h"

namespace airtruth::own_aircraft {
namespace {

// The constants of this file were chosen on the virtual flights of surroundings_slow_test.cpp.

// The steady limit, as a multiple of the median, and its least value in code values.
constexpr float kSteadyMedians = 3, kMinSteady = 5;
// A part as steady as the largest one: its median standard deviation is at most this multiple of
// that of the largest part, plus code values. Cloud may have the colour of the aircraft and hardly
// move, but it changes more over time.
constexpr float kAsSteady = 1.6F, kAsSteadyCodes = 0.3F;
// A part smaller than the largest one divided by kLargestOverPart, or than the picture divided by
// kPictureOverPart, is a corner of sky.
constexpr int kLargestOverPart = 20, kPictureOverPart = 2000;
// Least share of a part that is certain.
constexpr double kMinCertainShare = 0.25;
// Rounds of GrabCut, chosen by judgement: each takes as long as the first.
constexpr int kGrabCutRounds = 5;
// The seed of GrabCut's clustering, fixed so that a clip gives the same mask each time.
constexpr int kGrabCutSeed = 1;

float median_where(const cv::Mat& values, const cv::Mat& where) {
  std::vector<float> chosen;
  for (int y = 0; y < values.rows; ++y)
    for (int x = 0; x < values.cols; ++x)
      if (where.at<unsigned char>(y, x) != 0) chosen.push_back(values.at<float>(y, x));
  return median_or_0(std::move(chosen));
}

// The connected parts of a picture that is not 0; part 0 is the rest.
struct Parts {
  cv::Mat labels, statistics;
  int count = 0;

  Parts(const cv::Mat& picture, int connectivity) {
    cv::Mat centres;
    count = cv::connectedComponentsWithStats(picture, labels, statistics, centres, connectivity);
  }
  int area(int part) const { return statistics.at<int>(part, cv::CC_STAT_AREA); }
  cv::Mat where(int part) const { return labels == part; }
  // 0 if there is no part.
  int largest() const {
    int largest = 0;
    for (int i = 1; i < count; ++i)
      if (largest == 0 || area(i) > area(largest)) largest = i;
    return largest;
  }
  bool reaches_border(int part) const {
    const int* s = statistics.ptr<int>(part);
    return s[cv::CC_STAT_LEFT] <= 1 || s[cv::CC_STAT_TOP] <= 1 ||
           s[cv::CC_STAT_LEFT] + s[cv::CC_STAT_WIDTH] >= labels.cols - 1 ||
           s[cv::CC_STAT_TOP] + s[cv::CC_STAT_HEIGHT] >= labels.rows - 1;
  }
};

// Small holes in the aircraft are part of it.
void fill_holes(cv::Mat& region, int max_area) {
  const Parts holes(region == 0, 4);
  for (int i = 1; i < holes.count; ++i)
    if (holes.area(i) < max_area) region.setTo(1, holes.where(i));
}

}  // namespace

float steady_limit(const cv::Mat& spread, const cv::Mat& candidates) {
  return std::max(kMinSteady, kSteadyMedians * median_where(spread, candidates));
}

void distrust_changing(cv::Mat& labels, const cv::Mat& spread, float steady) {
  labels.setTo(cv::GC_PR_BGD, (labels == cv::GC_FGD) & (spread > steady));
  labels.setTo(cv::GC_PR_BGD, (labels == cv::GC_PR_FGD) & (spread > steady));
  labels.setTo(cv::GC_BGD, spread > 2 * steady);
}

cv::Mat region_from_labels(const cv::Mat& features, const cv::Mat& labels) {
  cv::Mat result = labels.clone(), background_model, foreground_model;
  cv::setRNGSeed(kGrabCutSeed);
  cv::grabCut(features,
              result,
              {},
              background_model,
              foreground_model,
              kGrabCutRounds,
              cv::GC_INIT_WITH_MASK);
  return result & 1;
}

void keep_certain_parts(cv::Mat& region, const cv::Mat& certain, const cv::Mat& spread) {
  const Parts parts(region, 8);
  const int main_part = parts.largest();
  const int least = region.cols * region.rows / kPictureOverPart;
  const int min_area =
      main_part > 0 ? std::max(least, parts.area(main_part) / kLargestOverPart) : least;
  const float steady = main_part > 0 ? median_where(spread, parts.where(main_part)) : 0;
  for (int i = 1; i < parts.count; ++i) {
    const cv::Mat here = parts.where(i);
    const bool is_certain = cv::countNonZero(here & certain) > kMinCertainShare * parts.area(i);
    if (!parts.reaches_border(i) || parts.area(i) < min_area || !is_certain ||
        median_where(spread, here) > kAsSteady * steady + kAsSteadyCodes)
      region.setTo(0, here);
  }
  fill_holes(region, least);
}

cv::Mat refined(const cv::Mat& region,
                const cv::Mat& features,
                const cv::Mat& spread,
                float steady) {
  cv::Mat large;
  cv::resize(region, large, features.size(), 0, 0, cv::INTER_NEAREST);
  // Half the width of the band: three working pixels, since the border at the working size may lie
  // off by that much, and two of full size.
  const int reach = 2 + 3 * features.cols / region.cols;
  const cv::Mat kernel =
      cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * reach + 1, 2 * reach + 1});
  cv::Mat inner, outer;
  cv::erode(large, inner, kernel);
  cv::dilate(large, outer, kernel);
  cv::Mat labels(large.size(), CV_8UC1, cv::Scalar(cv::GC_BGD));
  labels.setTo(cv::GC_PR_BGD, outer);
  labels.setTo(cv::GC_PR_FGD, large);
  labels.setTo(cv::GC_BGD, spread > 2 * steady);
  labels.setTo(cv::GC_FGD, inner);
  cv::Mat found = cv::countNonZero(inner) > 0 ? region_from_labels(features, labels) : large;
  // Pixels on the border show aircraft in part, so the mask includes them.
  cv::dilate(found, found, cv::getStructuringElement(cv::MORPH_CROSS, {3, 3}));
  return found;
}

}  // namespace airtruth::own_aircraft
