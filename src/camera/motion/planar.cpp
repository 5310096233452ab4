// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>

#include <opencv2/imgproc.hpp>

#include "camera/motion/corners.h"
#include "camera/motion/follower.h"
#include "camera/opencv_plugin/opencv_plugin.h"

namespace airtruth::motion {
namespace {

// The map from a key frame to a later frame, with its inliers among the corners.
struct ModelFit {
  Homography frame_from_key = Homography::Identity();  // OpenCV's integer-centred pixels
  std::vector<bool> is_inlier;
  int inliers = 0;
  double rms_px = 0;
};

// The least extent of the inliers for a homography, as a share of the image's sides (span_of).
// Chosen by judgement, as are the two constants below.
constexpr double kMinSpan = 0.35;
// The least share of the corners that are inliers. Doubled, frames with much near ground are
// bridged.
constexpr double kMinInlierShare = 0.35;
// The limit of the second fit in units of the first one's (fit_model()).
constexpr double kLooser = 3;

Homography eigen_from(const cv::Mat& h) {
  Homography result = Homography::Identity();
  for (int r = 0; r < h.rows; ++r)
    for (int c = 0; c < 3; ++c) result(r, c) = h.at<double>(r, c);
  return result;
}

// The square root of the hull's area over the image's area.
double span_of(const std::vector<cv::Point2f>& points, cv::Size image) {
  if (points.size() < 3) return 0;
  std::vector<cv::Point2f> hull;
  cv::convexHull(points, hull);
  return std::sqrt(cv::contourArea(hull) / (double(image.width) * image.height));
}

// Whether the map keeps the orientation at every corner of the image, and moves and scales it as
// little as a camera does between two key frames.
bool plausible(const Homography& h, cv::Size image) {
  if (!h.allFinite()) return false;
  const double reach = 1.5 * std::hypot(image.width, image.height);
  for (const Pixel& corner : {Pixel(0, 0),
                              Pixel(image.width, 0),
                              Pixel(0, image.height),
                              Pixel(image.width, image.height)}) {
    const Vector3 q = h * Vector3(corner.x(), corner.y(), 1);
    if (!(q.z() > 0.2 && q.z() < 5)) return false;
    if ((Pixel(q.x() / q.z(), q.y() / q.z()) - corner).norm() > reach) return false;
    // The determinant of the local linear map.
    const double local = h.determinant() / (q.z() * q.z() * q.z());
    if (!(local > 0.2 && local < 5)) return false;
  }
  return true;
}

std::vector<cv::Point2f> chosen(const std::vector<cv::Point2f>& points, const cv::Mat& mask) {
  std::vector<cv::Point2f> result;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (mask.at<unsigned char>(static_cast<int>(i)) != 0) result.push_back(points[i]);
  return result;
}

void measure(ModelFit& fit, const Tracks& tracks, double limit_px) {
  const auto& [key, now] = tracks;
  double squares = 0;
  fit.inliers = 0;
  fit.is_inlier.assign(key.size(), false);
  for (std::size_t i = 0; i < key.size(); ++i) {
    const Pixel p = apply(fit.frame_from_key, {key[i].x, key[i].y});
    const double miss = (p - Pixel(now[i].x, now[i].y)).squaredNorm();
    if (!(miss <= limit_px * limit_px)) continue;
    fit.is_inlier[i] = true;
    ++fit.inliers;
    squares += miss;
  }
  fit.rms_px = fit.inliers > 0 ? std::sqrt(squares / fit.inliers) : 0;
}

std::optional<ModelFit> fit_within(const Tracks& tracks, cv::Size image, double limit_px) {
  const auto& [key, now] = tracks;
  cv::Mat mask;
  cv::Mat h =
      opencv_plugin::functions().find_homography(key, now, cv::RANSAC, limit_px, mask, 1000, 0.999);
  const bool use_homography = !h.empty() && span_of(chosen(key, mask), image) >= kMinSpan &&
                              plausible(eigen_from(h), image);
  if (!use_homography) {
    h = opencv_plugin::functions().estimate_affine_partial_2d(
        key, now, mask, cv::RANSAC, 1.5 * limit_px, 1000, 0.999, 10);
    if (h.empty() || !plausible(eigen_from(h), image)) return std::nullopt;
  }
  ModelFit fit;
  fit.frame_from_key = eigen_from(h);
  measure(fit, tracks, (use_homography ? 1.0 : 1.5) * limit_px);
  if (fit.inliers < kMinInliers || fit.inliers < kMinInlierShare * static_cast<double>(key.size()))
    return std::nullopt;
  return fit;
}

// Fits the plane map from the key frame (motion.h; least squares by Levenberg-Marquardt). The fit
// is a homography where the hull of the inliers covers enough of the image (kMinSpan). Otherwise,
// for example with clouds along a horizon, it is a similarity, since a homography from a thin band
// of points extrapolates badly. The result is empty where there are fewer than kMinInliers inliers,
// or where the map is no motion that a camera makes between two key frames.
std::optional<ModelFit> fit_model(const Tracks& tracks, cv::Size image) {
  if (static_cast<int>(tracks.begun.size()) < kMinInliers) return std::nullopt;
  // A plane map is not exact for a wide lens or near ground, so a second fit with a larger limit
  // follows before the function gives up. A larger rms_px shows that it was needed.
  for (double limit_px : {kInlierPx, kLooser * kInlierPx})
    if (const auto fit = fit_within(tracks, image, limit_px)) return fit;
  return std::nullopt;
}

// With a smaller share of its corners left, a new key frame is made. Chosen by judgement. Doubled,
// key frames follow one another twice as fast, and each adds the error of a map.
constexpr double kMinKeptShare = 0.4;

// Converts a map between OpenCV's integer-centred pixels to airtruth's: p_airtruth = p_cv + 0.5.
Homography ours_from_cv(const Homography& h) {
  Homography to = Homography::Identity();
  to(0, 2) = to(1, 2) = 0.5;
  const Homography result = to * h * to.inverse();
  return result / result(2, 2);
}

class Planar : public Follower {
 public:
  explicit Planar(const cv::Mat& allowed) : allowed_(allowed) {}

  FrameMotion next(const cv::Mat& grey, bool damaged, bool begins_shot) override {
    Pyramid now = pyramid_of(grey);
    if (previous_.empty()) {
      previous_ = std::move(now);
      make_key(spread_corners(grey, allowed_));
      return {};
    }
    // The samples of a damaged frame are unreliable. The next intact frame is linked to the last
    // one.
    if (damaged) return bridged(State::kBridged);
    const std::size_t before = tracks_.now.size();
    const Tracks tracks = followed(previous_, now, allowed_, tracks_);
    const auto fit = fit_model(tracks, grey.size());
    if (fit && is_followed(begins_shot, fit->inliers, before)) {
      const FrameMotion motion = measured(*fit, tracks, grey);
      previous_ = std::move(now);
      return motion;
    }
    ++bridged_in_row_;
    const std::vector<cv::Point2f> fresh = spread_corners(grey, allowed_);
    const CornerLoss loss =
        corner_loss(fresh.size(), before, tracks.now.size(), bridged_in_row_, begins_shot);
    if (loss.starts_anew) {
      // Tracking starts anew from this frame; the position of the last linked frame is kept.
      previous_ = std::move(now);
      make_key(fresh);
      bridged_in_row_ = 0;
    }
    return bridged(loss.is_cut ? State::kCut : State::kBridged);
  }

 private:
  void make_key(const std::vector<cv::Point2f>& corners) {
    tracks_ = {corners, corners};
    key_count_ = corners.size();
    key_from_first_ = now_from_first_;
  }

  FrameMotion bridged(State state) const {
    FrameMotion motion;
    motion.frame_from_reference = ours_from_cv(now_from_first_);  // the state says that it is held
    motion.state = state;
    return motion;
  }

  FrameMotion measured(const ModelFit& fit, const Tracks& tracks, const cv::Mat& grey) {
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
    // Outliers are dropped: a corner that does not follow the far plane now will not follow it
    // later.
    tracks_ = {};
    for (std::size_t i = 0; i < tracks.begun.size(); ++i)
      if (fit.is_inlier[i])
        tracks_.begun.push_back(tracks.begun[i]), tracks_.now.push_back(tracks.now[i]);
    if (static_cast<double>(tracks_.begun.size()) < kMinKeptShare * static_cast<double>(key_count_))
      make_key(spread_corners(grey, allowed_));
    return motion;
  }

  cv::Mat allowed_;
  // The corners of the key frame in the latest frame, and its map from the first frame (OpenCV's
  // pixels).
  Tracks tracks_;
  Homography key_from_first_ = Homography::Identity();
  Homography now_from_first_ = Homography::Identity();
  std::size_t key_count_ = 0;
  Pyramid previous_;
  int bridged_in_row_ = 0;
};

}  // namespace

std::unique_ptr<Follower> planar_follower(const cv::Mat& allowed) {
  return std::make_unique<Planar>(allowed);
}

}  // namespace airtruth::motion
