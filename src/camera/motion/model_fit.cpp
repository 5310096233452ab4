// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/model_fit.h"

#include <cmath>

#include <opencv2/calib3d.hpp>  // constants alone
#include <opencv2/imgproc.hpp>

#include "camera/late_opencv/late_opencv.h"

namespace airtruth::motion {
namespace {

// The least extent of the inliers for a homography, as a share of the image's sides (span_of).
// Chosen by judgement, as are the two constants below.
constexpr double kMinSpan = 0.35;
constexpr double kMinInlierShare = 0.35;
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

void measure(ModelFit& fit,
             const std::vector<cv::Point2f>& key,
             const std::vector<cv::Point2f>& moved,
             double limit_px) {
  double squares = 0;
  fit.inliers = 0;
  fit.is_inlier.assign(key.size(), false);
  for (std::size_t i = 0; i < key.size(); ++i) {
    const Pixel p = apply(fit.frame_from_key, {key[i].x, key[i].y});
    const double miss = (p - Pixel(moved[i].x, moved[i].y)).squaredNorm();
    if (!(miss <= limit_px * limit_px)) continue;
    fit.is_inlier[i] = true;
    ++fit.inliers;
    squares += miss;
  }
  fit.rms_px = fit.inliers > 0 ? std::sqrt(squares / fit.inliers) : 0;
}

}  // namespace

namespace {

std::optional<ModelFit> fit_within(const std::vector<cv::Point2f>& key,
                                   const std::vector<cv::Point2f>& moved,
                                   cv::Size image,
                                   const Options& options,
                                   double limit_px) {
  cv::Mat mask;
  cv::Mat h = late::opencv().find_homography(key, moved, cv::RANSAC, limit_px, mask, 1000, 0.999);
  const bool use_homography = !h.empty() && span_of(chosen(key, mask), image) >= kMinSpan &&
                              plausible(eigen_from(h), image);
  if (!use_homography) {
    h = late::opencv().estimate_affine_partial_2d(
        key, moved, mask, cv::RANSAC, 1.5 * limit_px, 1000, 0.999, 10);
    if (h.empty() || !plausible(eigen_from(h), image)) return std::nullopt;
  }
  ModelFit fit;
  fit.frame_from_key = eigen_from(h);
  measure(fit, key, moved, (use_homography ? 1.0 : 1.5) * limit_px);
  if (fit.inliers < options.min_inliers ||
      fit.inliers < kMinInlierShare * static_cast<double>(key.size()))
    return std::nullopt;
  return fit;
}

}  // namespace

std::optional<ModelFit> fit_model(const std::vector<cv::Point2f>& key,
                                  const std::vector<cv::Point2f>& moved,
                                  cv::Size image,
                                  const Options& options) {
  if (static_cast<int>(key.size()) < options.min_inliers) return std::nullopt;
  // A plane map is not exact for a wide lens or near ground, so a second fit with a larger limit
  // follows before the function gives up. A larger rms_px shows that it was needed.
  for (double limit_px : {options.ransac_px, kLooser * options.ransac_px})
    if (const auto fit = fit_within(key, moved, image, options, limit_px)) return fit;
  return std::nullopt;
}

}  // namespace airtruth::motion
