// SPDX-License-Identifier: Apache-2.0
#include "runners/classical/free_view.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "foundation/image/mats.h"
#include "runners/classical/scale_space.h"

namespace airtruth::classical {
namespace {

// Side of the cells on which the replacement is computed, px: it is smooth.
constexpr int kFillCellPx = 4;

cv::Size cells_of(const cv::Size& size) {
  return {std::max(1, size.width / kFillCellPx), std::max(1, size.height / kFillCellPx)};
}

cv::Mat resized(const cv::Mat& picture, const cv::Size& size, int how) {
  cv::Mat result;
  cv::resize(picture, result, size, 0, 0, how);
  return result;
}

}  // namespace

cv::Mat halved(const cv::Mat& picture) {
  const cv::Mat even = picture({0, 0, picture.cols & ~1, picture.rows & ~1});
  return resized(even, {even.cols / 2, even.rows / 2}, cv::INTER_NEAREST);
}

void fill(cv::Mat& values, const cv::Mat& weights) {
  if (cv::countNonZero(weights) == static_cast<int>(weights.total())) return;
  if (std::max(values.cols, values.rows) < 2) return;
  const cv::Size half(std::max(1, values.cols / 2), std::max(1, values.rows / 2));
  const cv::Mat sums = resized(values.mul(weights), half, cv::INTER_AREA);
  const cv::Mat coarse_weights = resized(weights, half, cv::INTER_AREA);
  cv::Mat coarse;
  cv::divide(sums, cv::max(coarse_weights, 1e-6F), coarse);
  fill(coarse, coarse_weights);
  resized(coarse, values.size(), cv::INTER_LINEAR).copyTo(values, weights == 0);
}

FreeView::FreeView(const image::Mask* own_aircraft) {
  if (!own_aircraft || own_aircraft->free.empty()) return;
  cv::Mat hidden = image::mat_of(*own_aircraft) < 128;
  if (cv::countNonZero(hidden) == 0) return;
  // Side of the element, px, which reaches kMarginPx to each side.
  constexpr int kSide = 2 * kMarginPx + 1;
  cv::dilate(hidden, hidden, cv::getStructuringElement(cv::MORPH_ELLIPSE, {kSide, kSide}));
  cv::Mat visible;
  cv::Mat(hidden == 0).convertTo(visible, CV_32F, 1 / 255.0);
  free_share_ = resized(visible, cells_of(visible.size()), cv::INTER_AREA);
  hidden_.push_back(hidden);
  // A level's smoothing takes in its neighbours.
  while (std::min(hidden_.back().cols, hidden_.back().rows) >= 2) {
    cv::Mat reached;
    cv::dilate(hidden_.back(), reached, cv::Mat::ones(3, 3, CV_8U));
    hidden_.push_back(halved(reached));
  }
}

cv::Mat FreeView::luma(const image::Picture& picture) const {
  const cv::Mat luma = image::luma_of(picture);
  if (is_whole() || luma.size() != hidden_.front().size()) return luma;
  cv::Mat visible, cells;
  luma.copyTo(visible);
  visible.setTo(0, hidden_.front());
  resized(visible, free_share_.size(), cv::INTER_AREA).convertTo(cells, CV_32F);
  cv::divide(cells, cv::max(free_share_, 1e-6F), cells);
  fill(cells, free_share_);
  cells.convertTo(cells, CV_8U);
  resized(cells, luma.size(), cv::INTER_LINEAR).copyTo(visible, hidden_.front());
  return visible;
}

cv::Mat FreeView::hidden(std::size_t halvings) const {
  return halvings < hidden_.size() ? hidden_[halvings] : cv::Mat();
}

bool FreeView::hides(const Pixel& pixel) const {
  if (is_whole()) return false;
  const cv::Mat& hidden = hidden_.front();
  const cv::Point at(static_cast<int>(std::floor(pixel.x())),
                     static_cast<int>(std::floor(pixel.y())));
  return cv::Rect({}, hidden.size()).contains(at) && hidden.at<std::uint8_t>(at) != 0;
}

}  // namespace airtruth::classical
