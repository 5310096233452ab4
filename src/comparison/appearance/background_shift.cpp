// SPDX-License-Identifier: Apache-2.0
#include "comparison/appearance/background_shift.h"

#include <opencv2/imgproc.hpp>

#include "comparison/appearance/segment.h"

namespace airtruth::appearance {
namespace {

constexpr int kHalving = 2;  // the shift is found at half the size
// Fine detail, in code values, below which no shift can be determined.
constexpr double kMinTexture = 0.7;
constexpr double kMinResponse = 0.15;  // of the correlation's peak, 1: all power in one place

}  // namespace

std::optional<Pixel> BackgroundShift::add(const image::Picture& picture,
                                          const std::vector<Box>& aircraft) {
  cv::Mat small, coarse;
  cv::resize(float_luma(picture, {0, 0, picture.width, picture.height}),
             small,
             {picture.width / kHalving, picture.height / kHalving},
             0,
             0,
             cv::INTER_AREA);
  cv::GaussianBlur(small, coarse, {}, 4);
  cv::Mat fine = small - coarse;
  for (const Box& box : aircraft) {
    const double margin = 16;
    const PixelBox wide = pixels_of({(box.x - margin) / kHalving,
                                     (box.y - margin) / kHalving,
                                     (box.width + 2 * margin) / kHalving,
                                     (box.height + 2 * margin) / kHalving});
    if (const auto part = intersection(wide, {0, 0, fine.cols, fine.rows}))
      fine(cv::Rect(part->x, part->y, part->width, part->height)).setTo(0);
  }
  cv::Mat before = fine;
  std::swap(before, before_);
  if (before.empty() || before.size() != fine.size()) return std::nullopt;
  cv::Scalar mean, deviation;
  cv::meanStdDev(fine, mean, deviation);
  if (deviation[0] < kMinTexture) return std::nullopt;
  cv::Mat window;
  cv::createHanningWindow(window, fine.size(), CV_32F);
  double response = 0;
  const cv::Point2d shift = cv::phaseCorrelate(before, fine, window, &response);
  if (response < kMinResponse) return std::nullopt;
  return Pixel(kHalving * shift.x, kHalving * shift.y);
}

}  // namespace airtruth::appearance
