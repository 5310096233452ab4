// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/corners.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace airtruth::motion {
namespace {

constexpr int kPyramidLevels = 4;
// The pyramid levels for a corner with a guessed position, which is good to a pixel or two.
constexpr int kGuessedLevels = 1;
// The pyramid levels for tracking back, which starts at the corner's original position.
constexpr int kBackLevels = 1;
constexpr int kWindowPx = 13;
// Corners are spread over kGrid x kGrid cells.
constexpr int kGrid = 8;
// The least distance of a corner from the own aircraft.
constexpr int kMaskMarginPx = 9;
// The limit on far corners per cell, as a multiple of the limit on other corners.
constexpr int kFarInCell = 3;

}  // namespace

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

cv::Mat allowed_area(int width, int height, const image::Mask* own_aircraft) {
  cv::Mat allowed(height, width, CV_8UC1, cv::Scalar(255));
  if (own_aircraft == nullptr) return allowed;
  const cv::Mat free(own_aircraft->height,
                     own_aircraft->width,
                     CV_8UC1,
                     const_cast<unsigned char*>(own_aircraft->free.data()));
  cv::erode(
      free,
      allowed,
      cv::getStructuringElement(cv::MORPH_RECT, {2 * kMaskMarginPx + 1, 2 * kMaskMarginPx + 1}));
  return allowed;
}

// Corners are searched at half size, which is four times faster. The position need not be exact,
// since Lucas-Kanade tracks the surroundings of any point.
std::vector<cv::Point2f> spread_corners(const cv::Mat& grey,
                                        const cv::Mat& allowed,
                                        const Options& options,
                                        const std::function<bool(const cv::Point2f&)>& is_far) {
  const bool half = std::min(grey.cols, grey.rows) >= 400;
  cv::Mat image = grey;
  cv::Mat mask = allowed;
  if (half) {
    cv::resize(grey, image, {}, 0.5, 0.5, cv::INTER_AREA);
    cv::resize(allowed, mask, image.size(), 0, 0, cv::INTER_NEAREST);
  }
  const double scale = half ? 2.0 : 1.0;
  double distance = options.min_corner_distance_px;
  if (distance <= 0)
    distance = std::max(6.0, std::sqrt(double(grey.cols) * grey.rows / options.max_corners) * 0.35);
  std::vector<cv::Point2f> candidates;
  cv::goodFeaturesToTrack(image, candidates, 0, 0.0005, distance / scale, mask, 5);
  const int share = std::max(2, 5 * options.max_corners / (4 * kGrid * kGrid));
  const auto s = static_cast<float>(scale);
  std::vector<cv::Point2f> chosen;
  const auto choose = [&](const std::vector<cv::Point2f>& from, int in_cell, int most) {
    std::vector<int> taken(kGrid * kGrid, 0);
    for (const cv::Point2f& c : from) {  // strongest first
      const int column =
          std::min(kGrid - 1, static_cast<int>(c.x * kGrid / static_cast<float>(grey.cols)));
      const int row =
          std::min(kGrid - 1, static_cast<int>(c.y * kGrid / static_cast<float>(grey.rows)));
      int& count = taken[static_cast<std::size_t>(row * kGrid + column)];
      if (count >= in_cell || static_cast<int>(chosen.size()) >= most) continue;
      ++count;
      chosen.push_back(c);
    }
  };
  std::vector<cv::Point2f> far, near;
  for (const cv::Point2f& c : candidates) {
    const cv::Point2f full((c.x + 0.5f) * s - 0.5f, (c.y + 0.5f) * s - 0.5f);
    (is_far && is_far(full) ? far : near).push_back(full);
  }
  choose(far, kFarInCell * share, options.max_corners / 2);
  choose(near, share, options.max_corners);
  return chosen;
}

namespace {

// Pyramidal Lucas-Kanade from `corners` to `moved`, with the guess that `moved` holds or from the
// corners' own places. Returns for each corner whether it was found.
std::vector<unsigned char> tracked(const Pyramid& from,
                                   const Pyramid& to,
                                   const std::vector<cv::Point2f>& corners,
                                   std::vector<cv::Point2f>& moved,
                                   int levels,
                                   bool guessed) {
  // The search for one corner ends after 10 rounds, or once it moves by less than 0.03 px.
  const cv::TermCriteria enough(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 10, 0.03);
  // Least eigenvalue of the normal matrix, OpenCV's default.
  constexpr double kMinEigenvalue = 1e-4;
  std::vector<unsigned char> found;
  std::vector<float> unused;
  cv::calcOpticalFlowPyrLK(from,
                           to,
                           corners,
                           moved,
                           found,
                           unused,
                           {kWindowPx, kWindowPx},
                           levels,
                           enough,
                           guessed ? cv::OPTFLOW_USE_INITIAL_FLOW : 0,
                           kMinEigenvalue);
  return found;
}

}  // namespace

std::vector<bool> follow(const Pyramid& from,
                         const Pyramid& to,
                         const cv::Mat& allowed,
                         const std::vector<cv::Point2f>& corners,
                         std::vector<cv::Point2f>& moved,
                         bool guessed,
                         const Options& options) {
  std::vector<bool> good(corners.size(), false);
  if (corners.empty()) return good;
  const auto found =
      tracked(from, to, corners, moved, guessed ? kGuessedLevels : kPyramidLevels, guessed);
  std::vector<cv::Point2f> back = corners;
  const auto found_back = tracked(to, from, moved, back, kBackLevels, true);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const cv::Point2f& p = moved[i];
    const bool inside = p.x >= 0 && p.y >= 0 && p.x <= static_cast<float>(allowed.cols - 1) &&
                        p.y <= static_cast<float>(allowed.rows - 1);
    if (found[i] == 0 || found_back[i] == 0 || !inside) continue;
    if (cv::norm(back[i] - corners[i]) > options.forward_backward_px) continue;
    good[i] = allowed.at<unsigned char>(static_cast<int>(p.y), static_cast<int>(p.x)) != 0;
  }
  return good;
}

}  // namespace airtruth::motion
