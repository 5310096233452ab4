// SPDX-License-Identifier: Apache-2.0
#include "measure/own_aircraft/own_aircraft.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "camera/motion/motion.h"
#include "foundation/base/error.h"
#include "foundation/base/median.h"
#include "foundation/image/colour.h"
#include "picture/video/reader.h"

namespace airtruth::calibration {
namespace {

// Long side of the reduced picture on which the method works, px.
constexpr int kLongSide = 640;
constexpr std::size_t kMostKept = 48;
constexpr std::size_t kFewestKept = 6;
// Least motion between frames that are compared, px at the working size.
constexpr double kLeastMotionPx = 2;
// A pixel that never exceeds this value is black, code values.
constexpr float kBlack = 10;

struct Kept {
  // Luma at the working size, slightly blurred, float.
  cv::Mat grey;
  // In pixels of the full-size picture.
  Homography from_reference = Homography::Identity();
};

// Sums over the kept frames at full size.
struct Sums {
  cv::Mat rgb, squares;  // float; squares of grey
  int count = 0;

  void add(const cv::Mat& frame) {
    cv::Mat value, grey;
    frame.convertTo(value, CV_32FC3);
    cv::cvtColor(value, grey, cv::COLOR_RGB2GRAY);
    if (count++ == 0) {
      rgb = value;
      squares = grey.mul(grey);
    } else {
      rgb += value;
      squares += grey.mul(grey);
    }
  }

  // Standard deviation of grey over time.
  cv::Mat spread() const {
    cv::Mat grey, result;
    cv::cvtColor(rgb / double(count), grey, cv::COLOR_RGB2GRAY);
    result = squares / double(count) - grey.mul(grey);
    cv::max(result, 0, result);
    cv::sqrt(result, result);
    return result;
  }

  // The picture for GrabCut. Its channels are the mean grey, the standard deviation of grey over
  // time, and the difference between blue and red.
  cv::Mat features() const {
    const cv::Mat mean = rgb / double(count);
    cv::Mat grey, planes[3];
    cv::cvtColor(mean, grey, cv::COLOR_RGB2GRAY);
    cv::split(mean, planes);
    cv::Mat spread = this->spread();
    constexpr double kSpreadGain = 5;
    spread *= kSpreadGain;
    const cv::Mat colour = (planes[2] - planes[0]) * 0.7 + 128;
    cv::Mat result;
    cv::merge(std::vector<cv::Mat>{grey, spread, colour}, result);
    result.convertTo(result, CV_8UC3);
    return result;
  }
};

// Reads the video and keeps every n-th frame at the working size, with the motion of the world.
std::vector<Kept> keep_frames(video::Reader& reader,
                              const MaskOptions& options,
                              double scale,
                              Sums& sums) {
  const video::StreamInfo& info = reader.info();
  motion::Estimator estimator(info.width, info.height, {});
  const std::int64_t every =
      std::max<std::int64_t>(1, info.frame_count_estimate / static_cast<std::int64_t>(kMostKept));
  std::vector<Kept> kept;
  while (const auto frame = reader.next()) {
    if (options.stop.stop_requested()) throw Interrupted();
    const auto motion = estimator.next(frame->picture, frame->time_s, frame->damaged);
    if (options.progress) options.progress(frame->index + 1, info.frame_count_estimate);
    if (frame->index % every != 0 || frame->damaged || kept.size() >= 2 * kMostKept) continue;
    image::Rgb8 rgb = image::rgb8_from_picture(frame->picture);
    const cv::Mat whole(rgb.height, rgb.width, CV_8UC3, rgb.samples.get());
    sums.add(whole);
    Kept one;
    cv::Mat small;
    cv::resize(whole, small, {}, scale, scale, cv::INTER_AREA);
    cv::cvtColor(small, one.grey, cv::COLOR_RGB2GRAY);
    one.grey.convertTo(one.grey, CV_32F);
    cv::GaussianBlur(one.grey, one.grey, {}, 0.8);
    one.from_reference = motion.frame_from_reference;
    kept.push_back(std::move(one));
  }
  return kept;
}

// The homography between two kept frames at the working size, in OpenCV's pixels with integer
// centres.
cv::Matx33d small_step(const Kept& to, const Kept& from, double scale) {
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

struct Evidence {
  // Mean difference between the frames of a pair at the same place.
  cv::Mat still;
  // Mean difference between a place and the place to which the world moved.
  cv::Mat moving;
  cv::Mat brightest;
  int pairs = 0;
};

Evidence gather(const std::vector<Kept>& kept, double scale) {
  Evidence e;
  const cv::Size size = kept[0].grey.size();
  e.still = cv::Mat::zeros(size, CV_32F);
  e.moving = cv::Mat::zeros(size, CV_32F);
  e.brightest = cv::Mat::zeros(size, CV_32F);
  cv::Mat count = cv::Mat::zeros(size, CV_32F);
  for (const Kept& k : kept) cv::max(e.brightest, k.grey, e.brightest);
  for (std::size_t i = 0; i < kept.size(); ++i)
    for (const std::size_t step : {std::size_t{1}, std::size_t{3}, std::size_t{7}}) {
      if (i + step >= kept.size()) continue;
      const cv::Matx33d h = small_step(kept[i + step], kept[i], scale);
      const double moved = mean_motion_px(h, size);
      if (moved < kLeastMotionPx || moved > 0.25 * size.width) continue;
      cv::Mat there, inside;
      cv::warpPerspective(
          kept[i + step].grey, there, h, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);
      cv::warpPerspective(
          cv::Mat::ones(size, CV_32F), inside, h, size, cv::INTER_NEAREST | cv::WARP_INVERSE_MAP);
      cv::Mat still, moving;
      cv::absdiff(kept[i + step].grey, kept[i].grey, still);
      cv::absdiff(there, kept[i].grey, moving);
      cv::min(still, 40, still);
      cv::min(moving, 40, moving);
      e.still += still.mul(inside);
      e.moving += moving.mul(inside);
      count += inside;
      ++e.pairs;
    }
  cv::max(count, 1e-3, count);
  e.still /= count;
  e.moving /= count;
  return e;
}

image::Mask mask_of(const cv::Mat& aircraft) {
  image::Mask mask{aircraft.cols, aircraft.rows, {}};
  mask.free.resize(aircraft.total());
  for (int y = 0; y < aircraft.rows; ++y)
    for (int x = 0; x < aircraft.cols; ++x)
      mask.free[static_cast<std::size_t>(y) * static_cast<std::size_t>(aircraft.cols) +
                static_cast<std::size_t>(x)] = aircraft.at<unsigned char>(y, x) != 0 ? 0 : 255;
  return mask;
}

float middle_of(const cv::Mat& values, const cv::Mat& where) {
  std::vector<float> chosen;
  for (int y = 0; y < values.rows; ++y)
    for (int x = 0; x < values.cols; ++x)
      if (where.at<unsigned char>(y, x) != 0) chosen.push_back(values.at<float>(y, x));
  return median_or_0(std::move(chosen));
}

// Keeps the regions that reach the border of the picture, since the aircraft carries the camera,
// and of which enough was seen to stay still while the world moved.
void keep_what_was_seen(cv::Mat& aircraft, const cv::Mat& sure, const cv::Mat& spread) {
  cv::Mat labels, statistics, centres;
  const int count = cv::connectedComponentsWithStats(aircraft, labels, statistics, centres, 8);
  const int least = aircraft.cols * aircraft.rows / 2000;
  int largest = 0;
  int main_part = 0;
  for (int i = 1; i < count; ++i)
    if (const int area = statistics.at<int>(i, cv::CC_STAT_AREA); area > largest) {
      largest = area;
      main_part = i;
    }
  // Cloud may have the colour of the aircraft and hardly move, but it changes more over time.
  constexpr float kAsSteady = 1.6F;
  const float steady = main_part > 0 ? middle_of(spread, labels == main_part) : 0;
  // A region smaller than the largest one divided by this number is a corner of sky.
  constexpr int kOfLargest = 20;
  constexpr double kSeenShare = 0.25;
  for (int i = 1; i < count; ++i) {
    const int* s = statistics.ptr<int>(i);
    const bool at_border = s[cv::CC_STAT_LEFT] <= 1 || s[cv::CC_STAT_TOP] <= 1 ||
                           s[cv::CC_STAT_LEFT] + s[cv::CC_STAT_WIDTH] >= aircraft.cols - 1 ||
                           s[cv::CC_STAT_TOP] + s[cv::CC_STAT_HEIGHT] >= aircraft.rows - 1;
    const cv::Mat here = labels == i;
    const bool seen = cv::countNonZero(here & sure) > kSeenShare * s[cv::CC_STAT_AREA];
    if (!at_border || s[cv::CC_STAT_AREA] < std::max(least, largest / kOfLargest) || !seen ||
        middle_of(spread, here) > kAsSteady * steady + 0.3F)
      aircraft.setTo(0, here);
  }
  // Small holes in the aircraft are part of it.
  const cv::Mat free = aircraft == 0;
  const int holes = cv::connectedComponentsWithStats(free, labels, statistics, centres, 4);
  for (int i = 1; i < holes; ++i)
    if (statistics.at<int>(i, cv::CC_STAT_AREA) < least) aircraft.setTo(1, labels == i);
}

// The largest change over time that a pixel of the aircraft may have: a multiple of the change that
// most of the candidate pixels have.
float steady_limit(const cv::Mat& spread, const cv::Mat& candidates) {
  return std::max(5.0F, 3 * middle_of(spread, candidates));
}

cv::Mat cut(const cv::Mat& features, cv::Mat labels) {
  cv::Mat background_model, foreground_model;
  cv::setRNGSeed(1);
  cv::grabCut(features, labels, {}, background_model, foreground_model, 5, cv::GC_INIT_WITH_MASK);
  return labels & 1;
}

// Refines the border of the mask to full-size pixels. Only a band along the border is decided anew;
// the result at the working size holds elsewhere.
cv::Mat refined(const cv::Mat& coarse,
                const cv::Mat& features,
                const cv::Mat& spread,
                float steady) {
  cv::Mat large;
  cv::resize(coarse, large, features.size(), 0, 0, cv::INTER_NEAREST);
  const int reach = 2 + 3 * features.cols / coarse.cols;
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
  cv::Mat found = cv::countNonZero(inner) > 0 ? cut(features, labels) : large;
  // Pixels on the border show aircraft in part, so the mask includes them.
  cv::dilate(found, found, cv::getStructuringElement(cv::MORPH_CROSS, {3, 3}));
  return found;
}

}  // namespace

image::Mask find_own_aircraft(const fs::path& video, const MaskOptions& options) {
  video::Reader reader(video, {}, options.warn);
  const int width = reader.info().width;
  const int height = reader.info().height;
  const double scale = std::min(1.0, double(kLongSide) / std::max(width, height));
  Sums sums;
  const std::vector<Kept> kept = keep_frames(reader, options, scale, sums);
  if (kept.size() < kFewestKept)
    throw Error("is too short to tell the own aircraft from the world; expected " +
                    std::to_string(kFewestKept) + " frames or more",
                {video.string()});
  const Evidence e = gather(kept, scale);
  if (e.pairs < 3)
    throw Error(
        "is too still to tell the own aircraft from the world: the picture moves less than " +
            std::to_string(static_cast<int>(kLeastMotionPx / scale)) + " px",
        {video.string()});
  // A pixel shows the aircraft if it differs less at the same place than at the place to which the
  // world moved. Differences are compared with the noise of the clip.
  std::vector<float> values(e.still.begin<float>(), e.still.end<float>());
  std::nth_element(values.begin(),
                   values.begin() + static_cast<std::ptrdiff_t>(values.size() / 10),
                   values.end());
  const float noise = std::max(0.6F, values[values.size() / 10]);
  cv::Mat labels(e.still.size(), CV_8UC1, cv::Scalar(cv::GC_PR_BGD));
  cv::Mat still, moving;
  cv::GaussianBlur(e.still, still, {}, 1.0);
  cv::GaussianBlur(e.moving, moving, {}, 1.0);
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x) {
      const float s = still.at<float>(y, x);
      const float m = moving.at<float>(y, x);
      unsigned char& label = labels.at<unsigned char>(y, x);
      if (e.brightest.at<float>(y, x) < kBlack || m > 1.8F * s + noise)
        label = cv::GC_FGD;
      else if (s > 1.3F * m + noise)
        label = cv::GC_BGD;
      else if (m > 1.2F * s + 0.3F * noise)
        label = cv::GC_PR_FGD;
    }
  // A pixel of the world also fits badly if the aircraft hides its place in the other frame. But
  // the world changes over the whole clip, and the aircraft does not.
  cv::Mat spread;
  cv::resize(sums.spread(), spread, labels.size(), 0, 0, cv::INTER_AREA);
  const float steady = steady_limit(spread, labels == cv::GC_FGD);
  labels.setTo(cv::GC_PR_BGD, (labels == cv::GC_FGD) & (spread > steady));
  labels.setTo(cv::GC_PR_BGD, (labels == cv::GC_PR_FGD) & (spread > steady));
  labels.setTo(cv::GC_BGD, spread > 2 * steady);
  const cv::Mat sure = labels == cv::GC_FGD;
  if (cv::countNonZero(sure) < labels.rows * labels.cols / 1000)
    return mask_of(cv::Mat::zeros(height, width, CV_8UC1));
  const cv::Mat features = sums.features();
  cv::Mat small;
  cv::resize(features, small, labels.size(), 0, 0, cv::INTER_AREA);
  cv::Mat aircraft = cut(small, labels);
  keep_what_was_seen(aircraft, sure, spread);
  return mask_of(refined(aircraft, features, sums.spread(), steady));
}

}  // namespace airtruth::calibration
