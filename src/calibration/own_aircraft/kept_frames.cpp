// SPDX-License-Identifier: Apache-2.0
#include "calibration/own_aircraft/kept_frames.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "camera/motion/estimator.h"
#include "camera/motion/motion.h"
#include "foundation/base/error.h"
#include "foundation/image/colour.h"

namespace airtruth::own_aircraft {
namespace {

// Standard deviation of the blur of kept frames, working pixels: it suppresses noise and the
// aliasing that the reduction leaves.
constexpr double kBlurPx = 0.8;
// GrabCut compares channels of one scale, 0 to 255. These factors bring the standard deviation over
// time, a few code values, and the difference of colours to that scale.
constexpr double kSpreadGain = 5, kColourGain = 0.7, kColourOffset = 128;

cv::Mat reduced_grey(const cv::Mat& rgb, double scale) {
  cv::Mat small, grey;
  cv::resize(rgb, small, {}, scale, scale, cv::INTER_AREA);
  cv::cvtColor(small, grey, cv::COLOR_RGB2GRAY);
  grey.convertTo(grey, CV_32F);
  cv::GaussianBlur(grey, grey, {}, kBlurPx);
  return grey;
}

}  // namespace

void FrameSums::add(const cv::Mat& frame) {
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

cv::Mat FrameSums::spread() const {
  cv::Mat grey, result;
  cv::cvtColor(rgb / double(count), grey, cv::COLOR_RGB2GRAY);
  result = squares / double(count) - grey.mul(grey);
  cv::max(result, 0, result);
  cv::sqrt(result, result);
  return result;
}

cv::Mat FrameSums::features() const {
  const cv::Mat mean = rgb / double(count);
  cv::Mat grey, planes[3];
  cv::cvtColor(mean, grey, cv::COLOR_RGB2GRAY);
  cv::split(mean, planes);
  cv::Mat spread = this->spread();
  spread *= kSpreadGain;
  const cv::Mat colour = (planes[2] - planes[0]) * kColourGain + kColourOffset;
  cv::Mat result;
  cv::merge(std::vector<cv::Mat>{grey, spread, colour}, result);
  result.convertTo(result, CV_8UC3);
  return result;
}

KeptFrames keep_frames(video::Reader& reader, const MaskOptions& options, double scale) {
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
    image::Rgb8 rgb = image::rgb8_from_picture(frame->picture);
    const cv::Mat whole(rgb.height, rgb.width, CV_8UC3, rgb.samples.get());
    kept.sums.add(whole);
    kept.frames.push_back({reduced_grey(whole, scale), motion.frame_from_reference});
  }
  return kept;
}

}  // namespace airtruth::own_aircraft
