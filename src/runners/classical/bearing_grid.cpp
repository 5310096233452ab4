// SPDX-License-Identifier: Apache-2.0
#include "runners/classical/bearing_grid.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace airtruth::classical {
namespace {

// Cells between the nodes at which a map is exact; it is bilinear between them. Turns between
// anchors are of a few pixels: over the cells between two nodes, their map bends by a small part of
// a pixel.
constexpr int kNodeStep = 16;
// Turns of less do not change the nearest sample by much.
constexpr double kStandsStillPx = 0.25;
constexpr float kNowhere = -1e6F;  // cells; cv::remap takes it for outside

// Cells that cover so many px, in a number that vectors of four divide.
int columns_over(int width_px, int cell_px) {
  return ((width_px + cell_px - 1) / cell_px + 3) & ~3;
}

}  // namespace

BearingGrid::BearingGrid(const lens::Lens& lens, int cell_px)
    : lens_(lens),
      cell_px_(cell_px),
      size_(columns_over(lens.size().width, cell_px),
            (lens.size().height + cell_px - 1) / cell_px) {}

std::optional<Pixel> BearingGrid::pixel_of(const cv::Point& cell) const {
  const Pixel in_anchor(cell_px_ * (cell.x + 0.5), cell_px_ * (cell.y + 0.5));
  return pixel_after_turn(lens_, cam_from_anchor_, in_anchor);
}

double BearingGrid::largest_shift_px() const {
  double largest = 0;
  for (const double x : {0.05, 0.5, 0.95})
    for (const double y : {0.05, 0.5, 0.95}) {
      const Pixel pixel(x * lens_.size().width, y * lens_.size().height);
      const auto moved = pixel_after_turn(lens_, cam_from_anchor_, pixel);
      if (moved) largest = std::max(largest, (*moved - pixel).norm());
    }
  return largest;
}

cv::Mat BearingGrid::turn(const Quaternion& this_from_previous) {
  cam_from_anchor_ = (this_from_previous * cam_from_anchor_).normalized();
  const double shift_px = largest_shift_px();
  if (shift_px <= kLargestTurnPx) {
    cells_in_picture_ = shift_px < kStandsStillPx
                            ? cv::Mat()
                            : cells_after_turn(lens_, size_, cell_px_, cam_from_anchor_);
    return {};
  }
  // A cell of the new grid looks where the former grid has the camera's direction.
  const cv::Mat former_from_new =
      cells_after_turn(lens_, size_, cell_px_, cam_from_anchor_.conjugate());
  cam_from_anchor_ = Quaternion::Identity();
  cells_in_picture_.release();
  return former_from_new;
}

cv::Mat BearingGrid::seen_by_cells(const cv::Mat& samples) const {
  if (cells_in_picture_.empty()) return samples;
  cv::Mat seen;
  cv::remap(samples, seen, cells_in_picture_, {}, cv::INTER_NEAREST, cv::BORDER_CONSTANT);
  return seen;
}

cv::Mat cells_after_turn(const lens::Lens& lens,
                         const cv::Size& size,
                         int cell_px,
                         const Quaternion& other_from_this) {
  const cv::Size nodes(size.width / kNodeStep + 2, size.height / kNodeStep + 2);
  cv::Mat exact(nodes, CV_32FC2);
  for (int j = 0; j < nodes.height; ++j)
    for (int i = 0; i < nodes.width; ++i) {
      const Pixel pixel(cell_px * (kNodeStep * i + 0.5), cell_px * (kNodeStep * j + 0.5));
      const auto moved = pixel_after_turn(lens, other_from_this, pixel);
      exact.at<cv::Vec2f>(j, i) = moved ? cv::Vec2f(static_cast<float>(moved->x() / cell_px - 0.5),
                                                    static_cast<float>(moved->y() / cell_px - 0.5))
                                        : cv::Vec2f(kNowhere, kNowhere);
    }
  cv::Mat cells(size, CV_32FC2);
  for (int y = 0; y < size.height; ++y) {
    const int j = y / kNodeStep;
    const float v = static_cast<float>(y % kNodeStep) / kNodeStep;
    auto* row = cells.ptr<cv::Vec2f>(y);
    for (int x = 0; x < size.width; x += kNodeStep) {
      const int i = x / kNodeStep;
      const cv::Vec2f left =
          exact.at<cv::Vec2f>(j, i) * (1 - v) + exact.at<cv::Vec2f>(j + 1, i) * v;
      const cv::Vec2f right =
          exact.at<cv::Vec2f>(j, i + 1) * (1 - v) + exact.at<cv::Vec2f>(j + 1, i + 1) * v;
      const cv::Vec2f step = (right - left) * (1.0F / kNodeStep);
      cv::Vec2f here = left;
      for (int k = 0; k < kNodeStep && x + k < size.width; ++k, here += step) row[x + k] = here;
    }
  }
  return cells;
}

}  // namespace airtruth::classical
