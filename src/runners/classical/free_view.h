// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "foundation/geometry/transform.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

namespace airtruth::classical {

// The part of the picture in which the own aircraft hides nothing. The own aircraft's pixels are
// replaced by what is around them before anything is measured, so that its outline against the
// scene is neither an object nor noise, and nothing is detected on them.
class FreeView {
 public:
  // The own aircraft's outline is blurred by the lens and rings from the codec: pixels this near to
  // the mask count as hidden too.
  static constexpr int kMarginPx = 3;

  // Without a mask (nullptr) all is free.
  explicit FreeView(const image::Mask* own_aircraft = nullptr);

  bool is_whole() const { return hidden_.empty(); }
  // The luma with the own aircraft replaced; CV_8U. It shares the picture's samples where all is
  // free.
  cv::Mat luma(const image::Picture& picture) const;
  // CV_8U, 255 where a sample is hidden, for every second sample of every second row and so on:
  // number 0 has the picture's size. Empty where all is free.
  cv::Mat hidden(std::size_t halvings) const;
  bool hides(const Pixel& pixel) const;

 private:
  std::vector<cv::Mat> hidden_;
  cv::Mat free_share_;  // of the cells that the replacement is computed on
};

// Every second sample of every second row.
cv::Mat halved(const cv::Mat& picture);

// Replaces the values (CV_32F) whose weight is 0 by the weighted mean of the nearest ones with a
// weight, coarser the farther those are.
void fill(cv::Mat& values, const cv::Mat& weights);

}  // namespace airtruth::classical
