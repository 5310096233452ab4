// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"

namespace airtruth::classical {

// Where a camera that was turned otherwise sees what this one sees at a pixel; empty where it does
// not. Exact for a far point through any lens.
inline std::optional<Pixel> pixel_after_turn(const lens::Lens& lens,
                                             const Quaternion& other_from_this,
                                             const Pixel& pixel) {
  const auto ray = lens.ray_from_pixel(pixel);
  return ray ? lens.pixel_from_cam(other_from_this * *ray) : std::nullopt;
}

// A grid of bearings: the directions in which a camera of the same lens would see the cells of its
// picture if it stood still, in an attitude called the anchor. The measured turns say where the
// real camera sees each cell, so what is stored on the grid keeps its bearing while the camera
// shakes, and is not resampled. Once the camera has turned by more than kLargestTurnPx from the
// anchor, the grid is anchored anew.
class BearingGrid {
 public:
  // A choice: maps bend little over such a turn, and anchoring anew resamples what is stored.
  static constexpr double kLargestTurnPx = 12;

  BearingGrid(const lens::Lens& lens, int cell_px);

  // The width is a multiple of four, for vectors of four.
  cv::Size size() const { return size_; }
  // The camera turned. Returns the map by which the cells' content has to be carried (as cv::remap
  // takes it, CV_32FC2: for each cell, its position in cells of the former grid) where the grid was
  // anchored anew; empty otherwise.
  cv::Mat turn(const Quaternion& this_from_previous);
  // What a picture of a sample for each cell shows at the grid's cells: the nearest sample, and 0
  // where the camera does not see a cell.
  cv::Mat seen_by_cells(const cv::Mat& samples) const;
  // The position in the picture of a cell's centre; empty where the camera does not see it.
  std::optional<Pixel> pixel_of(const cv::Point& cell) const;

 private:
  double largest_shift_px() const;

  lens::Lens lens_;
  int cell_px_;
  cv::Size size_;
  Quaternion cam_from_anchor_ = Quaternion::Identity();
  cv::Mat cells_in_picture_;  // empty: the camera stands as the anchor does
};

// For each cell of a camera's picture, where a camera of the same lens that was turned otherwise
// has it: CV_32FC2, in cells, as cv::remap takes it (the first cell's centre is at 0). Far outside
// where that camera does not see it. Bilinear between exact nodes.
cv::Mat cells_after_turn(const lens::Lens& lens,
                         const cv::Size& cells,
                         int cell_px,
                         const Quaternion& other_from_this);

}  // namespace airtruth::classical
