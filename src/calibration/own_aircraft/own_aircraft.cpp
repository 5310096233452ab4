// SPDX-License-Identifier: Apache-2.0
#include "calibration/own_aircraft/own_aircraft.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "calibration/own_aircraft/aircraft_region.h"
#include "calibration/own_aircraft/kept_frames.h"
#include "calibration/own_aircraft/stillness.h"
#include "foundation/base/error.h"
#include "picture/video/reader.h"

namespace airtruth::own_aircraft {
namespace {

// Long side of the reduced picture on which the method works, px: it bounds the time of GrabCut.
constexpr int kWorkingLongSidePx = 640;
// Least numbers of kept frames, and of pairs of them between which the world moves.
constexpr std::size_t kMinKeptFrames = 6;
constexpr int kMinPairs = 3;
// A clip shows none of its own aircraft if less than the picture divided by this is certain.
constexpr int kPictureOverCertain = 1000;

image::Mask mask_of(const cv::Mat& aircraft) {
  image::Mask mask{aircraft.cols, aircraft.rows, {}};
  mask.free.resize(aircraft.total());
  for (int y = 0; y < aircraft.rows; ++y)
    for (int x = 0; x < aircraft.cols; ++x)
      mask.free[static_cast<std::size_t>(y) * static_cast<std::size_t>(aircraft.cols) +
                static_cast<std::size_t>(x)] = aircraft.at<unsigned char>(y, x) != 0 ? 0 : 255;
  return mask;
}

// Throws Error if the clip does not show what stays still and what moves.
void check_motion(const Stillness& pairs, double scale, const fs::path& video) {
  if (pairs.pairs < kMinPairs)
    throw Error(
        "is too still to separate the own aircraft from the world: the picture moves less than " +
            std::to_string(static_cast<int>(kMinPairMotionPx / scale)) + " px",
        {video.string()});
}

KeptFrames enough_frames(const fs::path& video,
                         video::Reader& reader,
                         const MaskOptions& options,
                         double scale) {
  KeptFrames kept = keep_frames(reader, options, scale);
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
  const auto [frames, sums] = enough_frames(video, reader, options, scale);
  const Stillness pairs = stillness_of(frames, scale);
  check_motion(pairs, scale, video);
  cv::Mat labels = labels_by_stillness(pairs);
  cv::Mat spread;
  cv::resize(sums.spread(), spread, labels.size(), 0, 0, cv::INTER_AREA);
  const float steady = steady_limit(spread, labels == cv::GC_FGD);
  distrust_changing(labels, spread, steady);
  const cv::Mat certain = labels == cv::GC_FGD;
  if (cv::countNonZero(certain) < labels.rows * labels.cols / kPictureOverCertain)
    return mask_of(cv::Mat::zeros(size, CV_8UC1));
  const cv::Mat features = sums.features();
  cv::Mat small;
  cv::resize(features, small, labels.size(), 0, 0, cv::INTER_AREA);
  cv::Mat region = region_from_labels(small, labels);
  keep_certain_parts(region, certain, spread);
  return mask_of(refined(region, features, sums.spread(), steady));
}

}  // namespace airtruth::own_aircraft
