// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include <opencv2/core.hpp>

#include "foundation/geometry/transform.h"
#include "foundation/image/picture.h"
#include "runners/classical/free_view.h"

// A picture at octaves of scale, and the response of close-minus-open at each.
namespace airtruth::classical {

// Samples hold grey levels times this, so that the mean of many pixels keeps its fractions.
inline constexpr int kGreyScale = 16;
// A response of this many times the typical one is that of an isolated object, not of noise.
inline constexpr double kIsolated = 6;
// Side of the square blocks over which noise is measured, in samples of a level.
inline constexpr int kBlock = 8;
// The blocks of a level, or of another grid of at least kBlock x kBlock. Where a side is no
// multiple of kBlock, the last block overlaps the one before it, so that blocks cover all samples.
inline cv::Size blocks_in(const cv::Size& samples) {
  return {(samples.width + kBlock - 1) / kBlock, (samples.height + kBlock - 1) / kBlock};
}
inline cv::Rect block_in(const cv::Size& samples, int bx, int by) {
  return {std::min(bx * kBlock, samples.width - kBlock),
          std::min(by * kBlock, samples.height - kBlock),
          kBlock,
          kBlock};
}
// The sum over a rectangle of blocks, of which `sums` is the integral (CV_64F).
inline double sum_within(const cv::Mat& sums, const cv::Rect& blocks) {
  const cv::Point low = blocks.tl(), high = blocks.br();
  return sums.at<double>(high.y, high.x) - sums.at<double>(low.y, high.x) -
         sums.at<double>(high.y, low.x) + sums.at<double>(low.y, low.x);
}
// Length of the structuring elements, in samples. Close-minus-open responds to objects of at most
// this length less one; the smoothing makes them two samples longer. So a level of n times fewer
// samples per side responds to objects of up to 4 n px.
inline constexpr int kElement = 7;
// Length of the elements along an object, on the levels above the first: an aircraft from ahead is
// several times as wide as it is high.
inline constexpr int kLongElement = 3 * kElement;
struct Level {
  // Side of a sample in pixels of the picture: 1, 2, 4, ...
  int step = 1;
  // CV_16S, grey levels times kGreyScale, smoothed by [1 2 1] / 4 in both directions.
  cv::Mat picture;
  // CV_16S, at least 0: how much darker (or brighter) a sample is than what closing (opening) by
  // lines along the rows and along the columns leaves, in the direction in which that is less: the
  // bottom-hat and the top-hat (Soille 2003, "Morphological Image Analysis", section 4), which Lai,
  // Ford, Mejias and O'Shea (2013) join as close-minus-open. Edges, and lines longer than the
  // elements along rows or columns, do not respond.
  cv::Mat response;
  // CV_8U, 255 where a sample responds as a dark one, 0 where as a bright one.
  cv::Mat is_dark;
  // CV_32F, one value for each block: the mean response of the block's surroundings, which follows
  // the noise and the clutter there.
  cv::Mat typical;
  // CV_16S, one value for each block: its largest response.
  cv::Mat largest;
  // CV_32F, one value for each block: the root mean square, over the blocks around, of the largest
  // response of those that hold an isolated object, as trees in a field, waves or small clouds do;
  // 0 in noise and in a clear sky. The block's own object does not count.
  cv::Mat clutter;
  // CV_64F, for each corner of a block: the sum of the squares of `largest` above and to the left.
  cv::Mat largest_squares;
  // CV_8U, 255 where a sample shows the own aircraft, and does not respond; empty: none does.
  cv::Mat hidden;

  // Mean response over the standard deviation of white noise in the smoothed picture, from a
  // simulation (classical_test.cpp repeats it).
  static constexpr double kMeanResponse = 0.8;
  // Closing and opening have noise of their own, which adds to that of the sample: the largest
  // responses are as of this many times the noise (classical_test.cpp).
  static constexpr double kLargestResponses = 1.2;
  // The least value that `typical` has, that of a sky without noise.
  static double quietest();
  // Where the centre of a sample lies in the picture, and the sample that is nearest to a position.
  Pixel pixel_of(double x, double y) const { return {step * x + 0.5, step * y + 0.5}; }
  cv::Point sample_at(const Pixel& pixel) const;
  // Response in units of the typical response there; 0 outside of the picture.
  double relative_response(const cv::Point& sample) const;
  // Whether no neighbouring block has a stronger response; of equal ones, the first counts.
  bool is_peak(int bx, int by) const;
  double clutter_at(const cv::Point& sample) const;
  // The standard deviation of the noise of `picture` that has the typical response there.
  double noise_at(const cv::Point& sample) const;
  bool hides(const cv::Point& sample) const {
    return !hidden.empty() && hidden.at<std::uint8_t>(sample) != 0;
  }
  // The sample of the largest relative response within `radius` samples of `centre`.
  cv::Point strongest_near(const cv::Point& centre, int radius) const;
};

// The levels of a picture's luma: as many as needed for objects of kLargestPx, as far as its size
// allows.
inline constexpr int kLargestPx = 128;
std::vector<Level> scale_space(const image::Picture& picture, const FreeView& view = FreeView());

}  // namespace airtruth::classical
