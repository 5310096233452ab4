// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/levels.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace airtruth::motion {

Levels levels_of(const cv::Mat& grey) {
  // The coarsest level has at least this many samples on its shorter side: a patch is a third of
  // it.
  constexpr int kMinSide = 48;
  Levels levels{grey};
  while (std::min(levels.back().cols, levels.back().rows) / 2 >= kMinSide) {
    const cv::Mat& fine = levels.back();
    const cv::Mat even = fine(cv::Rect(0, 0, fine.cols / 2 * 2, fine.rows / 2 * 2));
    cv::Mat half;
    cv::resize(even, half, {even.cols / 2, even.rows / 2}, 0, 0, cv::INTER_AREA);
    levels.push_back(std::move(half));
  }
  return levels;
}

}  // namespace airtruth::motion
