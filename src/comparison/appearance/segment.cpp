// SPDX-License-Identifier: Apache-2.0
#include "comparison/appearance/segment.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "foundation/base/error.h"
#include "foundation/base/median.h"
#include "foundation/geometry/box.h"
#include "foundation/image/mats.h"

namespace airtruth::appearance {
namespace {

// Where a constant of this file states no origin, it is a choice.

constexpr double kMinDifference = 8;  // code values that the aircraft differs by
constexpr double kDeviations = 4;     // of the rim's spread that the aircraft differs by
constexpr int kMinArea = 3;           // px of a silhouette

// a + b x + c y through the samples, x and y from the middle.
cv::Vec3d plane_through(const cv::Mat& grey, const cv::Mat& where) {
  cv::Matx33d normal = cv::Matx33d::zeros();
  cv::Vec3d right(0, 0, 0);
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x < grey.cols; ++x) {
      if (where.at<unsigned char>(y, x) == 0) continue;
      const cv::Vec3d row(1, x - grey.cols / 2.0, y - grey.rows / 2.0);
      normal += row * row.t();
      right += double(grey.at<float>(y, x)) * row;
    }
  const double count = normal(0, 0);
  if (count < 6) return {count > 0 ? right[0] / count : 0, 0, 0};
  return normal.solve(right, cv::DECOMP_SVD);
}

cv::Mat picture_of_plane(const cv::Vec3d& plane, const cv::Size& size) {
  cv::Mat result(size, CV_32F);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      result.at<float>(y, x) = static_cast<float>(plane[0] + plane[1] * (x - size.width / 2.0) +
                                                  plane[2] * (y - size.height / 2.0));
  return result;
}

double spread_about(const cv::Mat& grey, const cv::Mat& level, const cv::Mat& where) {
  std::vector<double> off;
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x < grey.cols; ++x)
      if (where.at<unsigned char>(y, x) != 0)
        off.push_back(std::abs(double(grey.at<float>(y, x)) - double(level.at<float>(y, x))));
  return kSigmaOfMad * median_or_0(std::move(off));
}

cv::Mat rim_of(const cv::Size& size) {
  const int width = std::max(2, std::min(size.width, size.height) / 8);
  cv::Mat rim(size, CV_8UC1, cv::Scalar(255));
  if (size.width > 2 * width && size.height > 2 * width)
    rim(cv::Rect(width, width, size.width - 2 * width, size.height - 2 * width)).setTo(0);
  return rim;
}

bool reaches_edge(const cv::Rect& bounds, const cv::Size& size) {
  return bounds.x == 0 || bounds.y == 0 || bounds.br().x == size.width ||
         bounds.br().y == size.height;
}

}  // namespace

cv::Mat float_luma(const image::Picture& picture, const PixelBox& area) {
  check(area.x >= 0 && area.y >= 0 && area.right() <= picture.width &&
            area.bottom() <= picture.height,
        "an area of luma lies within its picture");
  cv::Mat grey;
  image::luma_of(picture, area).convertTo(grey, CV_32F);
  return grey;
}

cv::Mat surroundings_of(const cv::Mat& grey, const cv::Mat& where) {
  const cv::Mat first = picture_of_plane(plane_through(grey, where), grey.size());
  const double limit = std::max(2.0, 2.5 * spread_about(grey, first, where));
  cv::Mat near;
  cv::absdiff(grey, first, near);
  cv::Mat kept = (near <= limit) & where;
  // Less than half is left where the first fit lies between two levels; it then stands.
  if (2 * cv::countNonZero(kept) < cv::countNonZero(where)) return first;
  return picture_of_plane(plane_through(grey, kept), grey.size());
}

cv::Mat silhouette_of(const cv::Mat& grey, double reach_px, bool whole) {
  const cv::Mat rim = rim_of(grey.size());
  const cv::Mat level = surroundings_of(grey, rim);
  const double limit = std::max(kMinDifference, kDeviations * spread_about(grey, level, rim));
  cv::Mat difference, labels, statistics, centres;
  cv::absdiff(grey, level, difference);
  cv::Mat mask = difference > limit;
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
  const int count = cv::connectedComponentsWithStats(mask, labels, statistics, centres, 8);
  int best = 0, most = kMinArea - 1;
  for (int i = 1; i < count; ++i) {
    const double away = std::hypot(centres.at<double>(i, 0) + 0.5 - grey.cols / 2.0,
                                   centres.at<double>(i, 1) + 0.5 - grey.rows / 2.0);
    const int area = statistics.at<int>(i, cv::CC_STAT_AREA);
    const cv::Rect bounds(statistics.at<int>(i, cv::CC_STAT_LEFT),
                          statistics.at<int>(i, cv::CC_STAT_TOP),
                          statistics.at<int>(i, cv::CC_STAT_WIDTH),
                          statistics.at<int>(i, cv::CC_STAT_HEIGHT));
    if (whole && reaches_edge(bounds, grey.size())) continue;
    if (area > most && away <= reach_px) most = area, best = i;
  }
  if (best == 0) return cv::Mat(grey.size(), CV_8UC1, cv::Scalar(0));
  return labels == best;
}

std::optional<Seen> seen_in(const image::Picture& picture, const Box& loose) {
  const double margin = std::max(4.0, std::max(loose.width, loose.height) / 4);
  const PixelBox wide = pixels_of(wider(loose, margin));
  if (wide.x < 0 || wide.y < 0 || wide.right() > picture.width || wide.bottom() > picture.height)
    return std::nullopt;
  const cv::Mat mask =
      silhouette_of(float_luma(picture, wide), std::hypot(loose.width, loose.height) / 2, false);
  const cv::Rect bounds = cv::boundingRect(mask);
  if (bounds.empty() || std::max(bounds.width, bounds.height) < 3) return std::nullopt;
  if (reaches_edge(bounds, mask.size())) return std::nullopt;
  return Seen{{double(wide.x + bounds.x),
               double(wide.y + bounds.y),
               double(bounds.width),
               double(bounds.height)},
              mask(bounds).clone()};
}

}  // namespace airtruth::appearance
