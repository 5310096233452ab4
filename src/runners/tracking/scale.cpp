// SPDX-License-Identifier: Apache-2.0
#include "runners/tracking/scale.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "camera/opencv_plugin/opencv_plugin.h"
#include "foundation/base/median.h"
#include "runners/tracking/luma_window.h"

namespace airtruth::tracking {
namespace {

// Where a constant of this file states no origin, it is a choice.

constexpr double kSidePx = 48;  // geometric mean of the object's sides in its patch
constexpr int kColumns = 14;    // of points
constexpr int kRows = 8;        // in the object's usual aspect
constexpr int kWindowPx = 9;    // of the optical flow: the side of a point's surroundings
// Points with less than this share of the strongest texture in the object are left out.
constexpr double kMinTexture = 0.05;
constexpr std::size_t kMinPoints = 20;  // for a median that holds
// Number of pairs of points, for a median that holds.
constexpr std::size_t kMinPairs = 50;
constexpr double kMinApartPx = 5;  // of a pair, whose ratio is else mostly the flow's error
constexpr float kMaxReturnPx = 1;  // from where a point began, forward and backward
constexpr double kMaxChange =
    0.1;  // of the size from a frame to the next: at 10 Hz, 1 s from a pass

using Points = std::vector<cv::Point2f>;

// The object and half its size around it.
image::Plane patch(const image::Plane& luma, const Box& box) {
  const double unit = std::sqrt(box.area()) / kSidePx;
  return resampled(luma,
                   box.x - box.width / 2,
                   box.y - box.height / 2,
                   unit,
                   static_cast<int>(std::lround(2 * box.width / unit)),
                   static_cast<int>(std::lround(2 * box.height / unit)));
}

cv::Mat view(const image::Plane& plane) {
  return {plane.height,
          plane.width,
          CV_8UC1,
          plane.samples.get(),
          static_cast<std::size_t>(plane.stride)};
}

// A grid of points over the object, at places with texture.
Points points_in(const cv::Mat& picture) {
  cv::Mat texture;
  cv::cornerMinEigenVal(picture, texture, kWindowPx);
  const cv::Rect object(picture.cols / 4, picture.rows / 4, picture.cols / 2, picture.rows / 2);
  double strongest = 0;
  cv::minMaxLoc(texture(object), nullptr, &strongest);
  Points points;
  for (int j = 0; j < kRows; ++j)
    for (int i = 0; i < kColumns; ++i) {
      const double x = picture.cols * (0.25 + 0.5 * (i + 0.5) / kColumns);
      const double y = picture.rows * (0.25 + 0.5 * (j + 0.5) / kRows);
      if (texture.at<float>(static_cast<int>(y), static_cast<int>(x)) >= kMinTexture * strongest)
        points.emplace_back(static_cast<float>(x), static_cast<float>(y));
    }
  return points;
}

struct Flow {
  Points from, to;
};

// Points that return to their origin when they are tracked forward and backward.
Flow followed(const cv::Mat& before, const cv::Mat& after, const Points& points) {
  Points there;
  Points back;
  std::vector<std::uint8_t> found;
  std::vector<std::uint8_t> returned;
  std::vector<float> unused;
  const cv::Size window(kWindowPx, kWindowPx);
  // The search for a point ends after 30 rounds, or once it moves by less than 0.01 px; the last
  // number is the least eigenvalue of the normal matrix. All are OpenCV's defaults.
  const cv::TermCriteria enough(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.01);
  const auto flow = opencv_plugin::functions().calc_optical_flow_pyr_lk;
  flow(before, after, points, there, found, unused, window, 2, enough, 0, 1e-4);
  flow(after, before, there, back, returned, unused, window, 2, enough, 0, 1e-4);
  std::vector<float> off;
  for (std::size_t i = 0; i < points.size(); ++i)
    off.push_back(found[i] != 0 && returned[i] != 0
                      ? static_cast<float>(cv::norm(points[i] - back[i]))
                      : INFINITY);
  std::vector<float> sorted = off;
  std::erase(sorted, INFINITY);
  if (sorted.empty()) return {};
  const float most = std::min(kMaxReturnPx, median(std::move(sorted)));
  Flow result;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (off[i] <= most) {
      result.from.push_back(points[i]);
      result.to.push_back(there[i]);
    }
  return result;
}

// Median over pairs of points of the ratio of their distances.
std::optional<double> median_ratio(const Flow& flow) {
  std::vector<double> ratios;
  for (std::size_t a = 0; a < flow.from.size(); ++a)
    for (std::size_t b = a + 1; b < flow.from.size(); ++b)
      if (const double apart = cv::norm(flow.from[a] - flow.from[b]); apart >= kMinApartPx)
        ratios.push_back(cv::norm(flow.to[a] - flow.to[b]) / apart);
  if (ratios.size() < kMinPairs) return std::nullopt;
  return median(std::move(ratios));
}

}  // namespace

void ScaleFollower::keep(const image::Plane& luma, const Box& box) { kept_ = patch(luma, box); }

std::optional<double> ScaleFollower::ratio(const image::Plane& luma, const Box& box) const {
  const image::Plane now = patch(luma, box);
  if (now.width != kept_.width || now.height != kept_.height) return std::nullopt;
  const Points points = points_in(view(kept_));
  if (points.size() < kMinPoints) return std::nullopt;
  const Flow flow = followed(view(kept_), view(now), points);
  if (flow.from.size() < kMinPoints) return std::nullopt;
  const auto ratio = median_ratio(flow);
  if (!ratio) return std::nullopt;
  return std::clamp(*ratio, 1 - kMaxChange, 1 + kMaxChange);
}

}  // namespace airtruth::tracking
