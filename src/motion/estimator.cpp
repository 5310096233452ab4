// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "base/error.h"
#include "motion/model_fit.h"
#include "motion/motion.h"

namespace airtruth::motion {
namespace {

constexpr int kPyramidLevels = 4;
constexpr int kBackLevels =
    1;  // the way back starts where the corner was: the fine levels say enough
constexpr int kWindowPx = 13;
constexpr int kGrid = 8;               // corners are spread over kGrid x kGrid cells
constexpr double kMinKeptShare = 0.4;  // of a key frame's corners, before a new key frame is made
constexpr int kPatience = 15;          // bridged frames in a row before tracking starts anew
constexpr int kMaskMarginPx = 9;       // corners keep this far from the own aircraft
constexpr double kCutShare =
    0.12;  // fewer survivors than this between two textured frames: the scene changed

using Pyramid = std::vector<cv::Mat>;

cv::Mat luma_of(const image::Picture& picture) {
  const image::Plane& plane = picture.luma();
  return {plane.height,
          plane.width,
          CV_8UC1,
          const_cast<std::uint8_t*>(plane.row(0)),
          static_cast<std::size_t>(plane.stride)};
}

Pyramid pyramid_of(const cv::Mat& grey) {
  Pyramid pyramid;
  cv::buildOpticalFlowPyramid(grey, pyramid, cv::Size(kWindowPx, kWindowPx), kPyramidLevels, true);
  return pyramid;
}

// OpenCV's integer-centred pixels to ours: p_ours = p_cv + 0.5.
Homography ours_from_cv(const Homography& h) {
  Homography to = Homography::Identity();
  to(0, 2) = to(1, 2) = 0.5;
  Homography from = Homography::Identity();
  from(0, 2) = from(1, 2) = -0.5;
  const Homography result = to * h * from;
  return result / result(2, 2);
}

}  // namespace

struct Estimator::Impl {
  int width;
  int height;
  Options options;
  cv::Mat allowed;  // 255 where corners may be

  // The key frame: its corners, where they are now, and its place against the first frame (OpenCV's
  // pixels).
  std::vector<cv::Point2f> key_corners;
  std::vector<cv::Point2f> now_corners;
  Homography key_from_first = Homography::Identity();
  Homography now_from_first = Homography::Identity();
  std::size_t key_count = 0;
  Pyramid previous;
  bool started = false;
  bool previous_damaged = false;
  int bridged_in_row = 0;

  Impl(int w, int h, const Options& o, const image::Mask* mask) : width(w), height(h), options(o) {
    allowed = cv::Mat(h, w, CV_8UC1, cv::Scalar(255));
    if (mask != nullptr) {
      const cv::Mat free(
          mask->height, mask->width, CV_8UC1, const_cast<unsigned char*>(mask->free.data()));
      cv::erode(free,
                allowed,
                cv::getStructuringElement(cv::MORPH_RECT,
                                          {2 * kMaskMarginPx + 1, 2 * kMaskMarginPx + 1}));
    }
  }

  std::vector<cv::Point2f> corners_of(const cv::Mat& grey) const;
  void make_key(const cv::Mat& grey);
  bool track(const Pyramid& now,
             std::vector<cv::Point2f>& key,
             std::vector<cv::Point2f>& moved) const;
  FrameMotion bridged(State state);
  FrameMotion next(const cv::Mat& grey, bool damaged);
  FrameMotion measured(const ModelFit& fit,
                       std::vector<cv::Point2f>& key,
                       std::vector<cv::Point2f>& moved,
                       const cv::Mat& grey);
};

// The best corners of each cell, so that no one cloud takes them all; searched at half size, where
// it is four times cheaper and as good, since Lucas-Kanade tracks whatever stands at the point.
std::vector<cv::Point2f> Estimator::Impl::corners_of(const cv::Mat& grey) const {
  const bool half = std::min(width, height) >= 400;
  cv::Mat image = grey;
  cv::Mat mask = allowed;
  if (half) {
    cv::resize(grey, image, {}, 0.5, 0.5, cv::INTER_AREA);
    cv::resize(allowed, mask, image.size(), 0, 0, cv::INTER_NEAREST);
  }
  const double scale = half ? 2.0 : 1.0;
  double distance = options.min_corner_distance_px;
  if (distance <= 0)
    distance = std::max(6.0, std::sqrt(double(width) * height / options.max_corners) * 0.35);
  std::vector<cv::Point2f> candidates;
  cv::goodFeaturesToTrack(image, candidates, 0, 0.0005, distance / scale, mask, 5);
  const int share = std::max(2, 5 * options.max_corners / (4 * kGrid * kGrid));
  std::vector<int> taken(kGrid * kGrid, 0);
  std::vector<cv::Point2f> chosen;
  for (const cv::Point2f& c : candidates) {  // best first
    const int column =
        std::min(kGrid - 1, static_cast<int>(c.x * kGrid / static_cast<float>(image.cols)));
    const int row =
        std::min(kGrid - 1, static_cast<int>(c.y * kGrid / static_cast<float>(image.rows)));
    int& count = taken[static_cast<std::size_t>(row * kGrid + column)];
    if (count >= share || static_cast<int>(chosen.size()) >= options.max_corners) continue;
    ++count;
    const auto s = static_cast<float>(scale);
    chosen.emplace_back((c.x + 0.5f) * s - 0.5f, (c.y + 0.5f) * s - 0.5f);
  }
  return chosen;
}

void Estimator::Impl::make_key(const cv::Mat& grey) {
  key_corners = now_corners = corners_of(grey);
  key_count = key_corners.size();
  key_from_first = now_from_first;
}

// Frame to frame with a forward-backward check; `key` keeps the corners that survive, `moved` where
// they are now.
bool Estimator::Impl::track(const Pyramid& now,
                            std::vector<cv::Point2f>& key,
                            std::vector<cv::Point2f>& moved) const {
  if (now_corners.empty()) return false;
  const cv::Size window(kWindowPx, kWindowPx);
  const cv::TermCriteria enough(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 10, 0.03);
  std::vector<cv::Point2f> forward;
  std::vector<cv::Point2f> back = now_corners;
  std::vector<unsigned char> found;
  std::vector<unsigned char> found_back;
  std::vector<float> unused;
  cv::calcOpticalFlowPyrLK(
      previous, now, now_corners, forward, found, unused, window, kPyramidLevels, enough, 0, 1e-4);
  cv::calcOpticalFlowPyrLK(now,
                           previous,
                           forward,
                           back,
                           found_back,
                           unused,
                           window,
                           kBackLevels,
                           enough,
                           cv::OPTFLOW_USE_INITIAL_FLOW,
                           1e-4);
  for (std::size_t i = 0; i < forward.size(); ++i) {
    const cv::Point2f& p = forward[i];
    const bool inside = p.x >= 0 && p.y >= 0 && p.x <= static_cast<float>(width - 1) &&
                        p.y <= static_cast<float>(height - 1);
    if (found[i] == 0 || found_back[i] == 0 || !inside) continue;
    if (cv::norm(back[i] - now_corners[i]) > options.forward_backward_px) continue;
    if (allowed.at<unsigned char>(static_cast<int>(p.y), static_cast<int>(p.x)) == 0) continue;
    key.push_back(key_corners[i]);
    moved.push_back(p);
  }
  return true;
}

FrameMotion Estimator::Impl::bridged(State state) {
  FrameMotion motion;
  motion.frame_from_reference = ours_from_cv(now_from_first);  // carried on, and said so
  motion.state = state;
  return motion;
}

FrameMotion Estimator::Impl::measured(const ModelFit& fit,
                                      std::vector<cv::Point2f>& key,
                                      std::vector<cv::Point2f>& moved,
                                      const cv::Mat& grey) {
  const Homography composed = fit.frame_from_key * key_from_first;
  now_from_first = composed / composed(2, 2);
  FrameMotion motion;
  motion.frame_from_reference = ours_from_cv(now_from_first);
  motion.inliers = fit.inliers;
  motion.rms_px = fit.rms_px;
  motion.state = State::kMeasured;
  bridged_in_row = 0;
  // Outliers are let go: what does not follow the far plane now will not follow it later.
  key_corners.clear();
  now_corners.clear();
  for (std::size_t i = 0; i < key.size(); ++i) {
    if (!fit.is_inlier[i]) continue;
    key_corners.push_back(key[i]);
    now_corners.push_back(moved[i]);
  }
  if (static_cast<double>(key_corners.size()) < kMinKeptShare * static_cast<double>(key_count))
    make_key(grey);
  return motion;
}

FrameMotion Estimator::Impl::next(const cv::Mat& grey, bool damaged) {
  Pyramid now = pyramid_of(grey);
  if (!started) {
    started = true;
    previous = std::move(now);
    make_key(grey);
    return {};
  }
  if (damaged) {  // its samples are not trusted; the next whole frame is linked to the last whole
                  // one
    return bridged(State::kBridged);
  }
  std::vector<cv::Point2f> key;
  std::vector<cv::Point2f> moved;
  const std::size_t before = now_corners.size();
  track(now, key, moved);
  const auto fit = fit_model(key, moved, {width, height}, options);
  if (fit) {
    const FrameMotion motion = measured(*fit, key, moved, grey);
    previous = std::move(now);
    return motion;
  }
  ++bridged_in_row;
  const std::vector<cv::Point2f> fresh = corners_of(grey);
  const bool textured = static_cast<int>(fresh.size()) >= 2 * options.min_inliers &&
                        static_cast<int>(before) >= 2 * options.min_inliers;
  const bool cut =
      textured && static_cast<double>(moved.size()) < kCutShare * static_cast<double>(before);
  if (cut || bridged_in_row >= kPatience || static_cast<int>(before) < options.min_inliers) {
    // Start anew from here; what is known of the place is carried on.
    previous = std::move(now);
    key_corners = now_corners = fresh;
    key_count = fresh.size();
    key_from_first = now_from_first;
    bridged_in_row = 0;
  }
  return bridged(cut ? State::kCut : State::kBridged);
}

Estimator::Estimator(int width, int height, const Options& options, const image::Mask* own_aircraft)
    : impl_(std::make_unique<Impl>(width, height, options, own_aircraft)) {}
Estimator::~Estimator() = default;
Estimator::Estimator(Estimator&&) noexcept = default;

FrameMotion Estimator::next(const image::Picture& picture, double time_s, bool damaged) {
  check(picture.width == impl_->width && picture.height == impl_->height, "frames keep their size");
  FrameMotion motion = impl_->next(luma_of(picture), damaged);
  motion.time_s = time_s;
  return motion;
}

const char* name(State state) {
  switch (state) {
    case State::kReference:
      return "reference";
    case State::kMeasured:
      return "measured";
    case State::kBridged:
      return "bridged";
    case State::kCut:
      return "cut";
  }
  return "";
}

}  // namespace airtruth::motion
