// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>

#include "camera/motion/corners.h"
#include "camera/motion/follower.h"
#include "camera/motion/model_fit.h"

namespace airtruth::motion {
namespace {

constexpr double kMinKeptShare = 0.4;  // with fewer corners of the key frame, a new one is made

// Converts a map between OpenCV's integer-centred pixels to airtruth's: p_airtruth = p_cv + 0.5.
Homography ours_from_cv(const Homography& h) {
  Homography to = Homography::Identity();
  to(0, 2) = to(1, 2) = 0.5;
  Homography from = Homography::Identity();
  from(0, 2) = from(1, 2) = -0.5;
  const Homography result = to * h * from;
  return result / result(2, 2);
}

class Planar : public Follower {
 public:
  Planar(const cv::Mat& allowed, const Options& options) : options_(options), allowed_(allowed) {}
  FrameMotion next(const cv::Mat& grey, bool damaged, bool begins_shot) override;

 private:
  void make_key(const cv::Mat& grey);
  void track(const Pyramid& now,
             std::vector<cv::Point2f>& key,
             std::vector<cv::Point2f>& moved) const;
  FrameMotion bridged(State state) const;
  FrameMotion measured(const ModelFit& fit,
                       const std::vector<cv::Point2f>& key,
                       const std::vector<cv::Point2f>& moved,
                       const cv::Mat& grey);

  Options options_;
  cv::Mat allowed_;
  // The key frame: its corners, their positions in the latest frame, and its map from the first
  // frame (OpenCV's pixels).
  std::vector<cv::Point2f> key_corners_;
  std::vector<cv::Point2f> now_corners_;
  Homography key_from_first_ = Homography::Identity();
  Homography now_from_first_ = Homography::Identity();
  std::size_t key_count_ = 0;
  Pyramid previous_;
  bool started_ = false;
  int bridged_in_row_ = 0;
};

void Planar::make_key(const cv::Mat& grey) {
  key_corners_ = now_corners_ = spread_corners(grey, allowed_, options_);
  key_count_ = key_corners_.size();
  key_from_first_ = now_from_first_;
}

// Tracks the corners into the frame. `key` keeps those that were found, and `moved` their
// positions.
void Planar::track(const Pyramid& now,
                   std::vector<cv::Point2f>& key,
                   std::vector<cv::Point2f>& moved) const {
  std::vector<cv::Point2f> forward;
  const auto good = follow(previous_, now, allowed_, now_corners_, forward, false, options_);
  for (std::size_t i = 0; i < good.size(); ++i) {
    if (!good[i]) continue;
    key.push_back(key_corners_[i]);
    moved.push_back(forward[i]);
  }
}

FrameMotion Planar::bridged(State state) const {
  FrameMotion motion;
  motion.frame_from_reference = ours_from_cv(now_from_first_);  // the state says that it is held
  motion.state = state;
  return motion;
}

FrameMotion Planar::measured(const ModelFit& fit,
                             const std::vector<cv::Point2f>& key,
                             const std::vector<cv::Point2f>& moved,
                             const cv::Mat& grey) {
  // h33 passes through 0 where the camera turns away from the first frame. The determinant does
  // not.
  const Homography composed = fit.frame_from_key * key_from_first_;
  now_from_first_ = composed / std::cbrt(composed.determinant());
  FrameMotion motion;
  motion.frame_from_reference = ours_from_cv(now_from_first_);
  motion.inliers = fit.inliers;
  motion.rms_px = fit.rms_px;
  motion.state = State::kMeasured;
  bridged_in_row_ = 0;
  // Outliers are dropped: a corner that does not follow the far plane now will not follow it later.
  key_corners_.clear();
  now_corners_.clear();
  for (std::size_t i = 0; i < key.size(); ++i) {
    if (!fit.is_inlier[i]) continue;
    key_corners_.push_back(key[i]);
    now_corners_.push_back(moved[i]);
  }
  if (static_cast<double>(key_corners_.size()) < kMinKeptShare * static_cast<double>(key_count_))
    make_key(grey);
  return motion;
}

FrameMotion Planar::next(const cv::Mat& grey, bool damaged, bool begins_shot) {
  Pyramid now = pyramid_of(grey);
  if (!started_) {
    started_ = true;
    previous_ = std::move(now);
    make_key(grey);
    return {};
  }
  // The samples of a damaged frame are unreliable. The next intact frame is linked to the last one.
  if (damaged) return bridged(State::kBridged);
  std::vector<cv::Point2f> key;
  std::vector<cv::Point2f> moved;
  const std::size_t before = now_corners_.size();
  track(now, key, moved);
  const auto fit = fit_model(key, moved, grey.size(), options_);
  if (fit && is_followed(begins_shot, fit->inliers, before)) {
    const FrameMotion motion = measured(*fit, key, moved, grey);
    previous_ = std::move(now);
    return motion;
  }
  ++bridged_in_row_;
  const std::vector<cv::Point2f> fresh = spread_corners(grey, allowed_, options_);
  const CornerLoss loss = corner_loss(
      fresh.size(), before, moved.size(), bridged_in_row_, options_.min_inliers, begins_shot);
  if (loss.starts_anew) {
    // Tracking starts anew from this frame; the position of the last linked frame is kept.
    previous_ = std::move(now);
    key_corners_ = now_corners_ = fresh;
    key_count_ = fresh.size();
    key_from_first_ = now_from_first_;
    bridged_in_row_ = 0;
  }
  return bridged(loss.is_cut ? State::kCut : State::kBridged);
}

}  // namespace

std::unique_ptr<Follower> planar_follower(const cv::Mat& allowed, const Options& options) {
  return std::make_unique<Planar>(allowed, options);
}

}  // namespace airtruth::motion
