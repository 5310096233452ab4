// SPDX-License-Identifier: Apache-2.0
#include "calibration/own_aircraft/own_aircraft.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "camera/motion/estimator.h"
#include "camera/motion/motion.h"
#include "foundation/base/error.h"
#include "foundation/base/median.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/colour.h"
#include "foundation/image/mats.h"
#include "picture/video/reader.h"

namespace airtruth::own_aircraft {
namespace {

// Long side of the reduced picture on which the method works, px: it bounds the time of GrabCut.
constexpr int kWorkingLongSidePx = 640;
// Number of frames that are kept of a clip, spread over it: at least half as many, at most twice as
// many, since the length of a clip is an estimate. It bounds memory: a kept frame takes 1 MB at the
// working size.
constexpr int kKeptFrames = 48;
// Least numbers of kept frames, and of pairs of them between which the world moves.
constexpr std::size_t kMinKeptFrames = 6;
constexpr int kMinPairs = 3;
// A clip shows none of its own aircraft if less than the picture divided by this is certain.
constexpr int kPictureOverCertain = 1000;

// Standard deviation of the blur of kept frames, working pixels: it suppresses noise and the
// aliasing that the reduction leaves.
constexpr double kBlurPx = 0.8;
// GrabCut compares channels of one scale, 0 to 255. These factors bring the standard deviation over
// time, a few code values, and the difference of colours to that scale.
constexpr double kSpreadGain = 5, kColourGain = 0.7, kColourOffset = 128;

// Distances between the frames of a pair, in kept frames: slow and fast motion are both covered.
constexpr std::array<std::size_t, 3> kPairDistances{1, 3, 7};
// Least motion between the frames of a pair, px at the working size. With less, both hypotheses fit
// the edges of either.
constexpr double kMinPairMotionPx = 2;
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

  // Standard deviation of grey over time, code values.
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
  cv::Mat features(const cv::Mat& spread) const {
    const cv::Mat mean = rgb / double(count);
    cv::Mat grey, planes[3];
    cv::cvtColor(mean, grey, cv::COLOR_RGB2GRAY);
    cv::split(mean, planes);
    const cv::Mat colour = (planes[2] - planes[0]) * kColourGain + kColourOffset;
    cv::Mat result;
    cv::merge(std::vector<cv::Mat>{grey, spread * kSpreadGain, colour}, result);
    result.convertTo(result, CV_8UC3);
    return result;
  }
};

struct KeptFrames {
  std::vector<KeptFrame> frames;
  FrameSums sums;
};

// What pairs of frames say about each pixel, at the working size; differences are in code values.
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

cv::Mat reduced_grey(const cv::Mat& rgb, double scale) {
  cv::Mat small, grey;
  cv::resize(rgb, small, {}, scale, scale, cv::INTER_AREA);
  cv::cvtColor(small, grey, cv::COLOR_RGB2GRAY);
  grey.convertTo(grey, CV_32F);
  cv::GaussianBlur(grey, grey, {}, kBlurPx);
  return grey;
}

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
  return std::max(kMinNoise, nth_smallest(values, values.size() / kNoiseQuantile));
}

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

// A first decision for each pixel, in the labels of GrabCut: certain (GC_FGD: the aircraft, GC_BGD:
// the world) or probable (GC_PR_FGD, GC_PR_BGD).
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

// The constants of the region were chosen on the virtual flights of surroundings_slow_test.cpp.

// The largest standard deviation over time that a pixel of the aircraft may have, as a multiple of
// the median of the candidates, and its least value in code values.
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

// Takes certainty from the labels of pixels that change more over time than the aircraft. A pixel
// of the world also fits badly if the aircraft hides its place in the other frame; but the world
// changes over the whole clip, and the aircraft does not.
void distrust_changing(cv::Mat& labels, const cv::Mat& spread, float steady) {
  labels.setTo(cv::GC_PR_BGD, (labels == cv::GC_FGD) & (spread > steady));
  labels.setTo(cv::GC_PR_BGD, (labels == cv::GC_PR_FGD) & (spread > steady));
  labels.setTo(cv::GC_BGD, spread > 2 * steady);
}

// The region that GrabCut finds from labels and features (FrameSums::features): 1 at the aircraft
// and 0 elsewhere.
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

// Keeps the parts of the region that reach the border of the picture, since the aircraft carries
// the camera, and of which enough is certain (`certain`) to stay still while the world moves.
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
  // Small holes in the aircraft are part of it.
  const Parts holes(region == 0, 4);
  for (int i = 1; i < holes.count; ++i)
    if (holes.area(i) < least) region.setTo(1, holes.where(i));
}

// Refines the border of the region to full-size pixels. Only a band along the border is decided
// anew; the result at the working size holds elsewhere. `features` and `spread` are at full size,
// and so is the result.
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

image::Mask mask_of(const cv::Mat& aircraft) {
  image::Mask mask{aircraft.cols, aircraft.rows, {}};
  mask.free.resize(aircraft.total());
  cv::Mat(aircraft == 0).copyTo(image::mat_of(mask));
  return mask;
}

// Reads the video to its end and keeps every n-th frame, reduced by `scale`, with the motion of the
// world. Throws Interrupted if options.stop asks for it, and Error if too few frames are kept.
KeptFrames keep_frames(const fs::path& video,
                       video::Reader& reader,
                       const MaskOptions& options,
                       double scale) {
  const video::StreamInfo& info = reader.info();
  motion::Estimator estimator(info.width, info.height);
  const std::int64_t every = std::max<std::int64_t>(1, info.frame_count_estimate / kKeptFrames);
  KeptFrames kept;
  while (const auto frame = reader.next()) {
    if (options.stop.stop_requested()) throw Interrupted();
    const auto motion = estimator.next(frame->picture, frame->time_s, frame->damaged);
    if (options.progress) options.progress(frame->index + 1, info.frame_count_estimate);
    if (frame->index % every != 0 || frame->damaged ||
        kept.frames.size() >= std::size_t{2 * kKeptFrames})
      continue;
    const image::Rgb8 rgb = image::rgb8_from_picture(frame->picture);
    const cv::Mat whole = image::mat_of(rgb);
    kept.sums.add(whole);
    kept.frames.push_back({reduced_grey(whole, scale), motion.frame_from_reference});
  }
  if (kept.frames.size() < kMinKeptFrames)
    throw Error("is too short to separate the own aircraft from the world; expected " +
                    std::to_string(kMinKeptFrames) + " frames or more",
                {video.string()});
  return kept;
}

}  // namespace

image::Mask find_own_aircraft(const fs::path& video, const MaskOptions& options) {
  video::Reader reader(video, {}, options.warn);
  const cv::Size size(reader.info().width, reader.info().height);
  const double scale =
      std::min(1.0, double(kWorkingLongSidePx) / std::max(size.width, size.height));
  const auto [frames, sums] = keep_frames(video, reader, options, scale);
  const Stillness pairs = stillness_of(frames, scale);
  if (pairs.pairs < kMinPairs)
    throw Error(
        "is too still to separate the own aircraft from the world: the picture moves less than " +
            std::to_string(static_cast<int>(kMinPairMotionPx / scale)) + " px",
        {video.string()});
  cv::Mat labels = labels_by_stillness(pairs);
  const cv::Mat spread = sums.spread();
  cv::Mat small_spread;
  cv::resize(spread, small_spread, labels.size(), 0, 0, cv::INTER_AREA);
  const float steady =
      std::max(kMinSteady, kSteadyMedians * median_where(small_spread, labels == cv::GC_FGD));
  distrust_changing(labels, small_spread, steady);
  const cv::Mat certain = labels == cv::GC_FGD;
  if (cv::countNonZero(certain) < labels.rows * labels.cols / kPictureOverCertain)
    return mask_of(cv::Mat::zeros(size, CV_8UC1));
  const cv::Mat features = sums.features(spread);
  cv::Mat small;
  cv::resize(features, small, labels.size(), 0, 0, cv::INTER_AREA);
  cv::Mat region = region_from_labels(small, labels);
  keep_certain_parts(region, certain, small_spread);
  return mask_of(refined(region, features, spread, steady));
}

}  // namespace airtruth::own_aircraft
