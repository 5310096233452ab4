// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "calibration/optics/step_response.h"
#include "foundation/image/tone_curve.h"

namespace airtruth::optics {

// The response of a camera to a step of light between two coded levels: a Gaussian spread in linear
// light, then the tone curve, then an unsharp mask on coded luma: the picture plus `amount` times
// the difference between the picture and its Gaussian blur. Heights are 0 and 1 far from the step.
// Places are in px from the middle of the coded step.
class StepModel {
 public:
  // The kernel of a mask's blur with this standard deviation, at the spacing of the table of
  // heights. Picture and blur are integrated over whole pixels.
  static std::vector<double> blur_of(double radius_px);

  StepModel(double spread_px,
            double amount,
            const std::vector<double>& blur,
            double low,
            double high,
            const image::ToneCurve& tone);

  // The height at a place and its slope per px.
  std::pair<double, double> at(double place_px) const;

 private:
  // Half the length of the table of heights, px: places beyond it have the height of its ends.
  static constexpr double kHalf = 9;
  // The number of table entries per pixel.
  static constexpr int kPerPixel = 10;
  // The number of table entries.
  static constexpr std::size_t kCount = 2 * static_cast<std::size_t>(kHalf) * kPerPixel + 1;
  void sharpen(double amount, const std::vector<double>& blur);
  double slope(std::size_t i) const;

  std::array<double, kCount> heights_{};
  double middle_ = 0;
};

// The samples across one edge, averaged in bins of a quarter of a pixel.
struct GatheredEdge {
  explicit GatheredEdge(const StepEdge& step);
  // Coded luma on the two sides of the edge, 0 to 1.
  double low = 0, high = 0;
  // For each bin: the mean place in px from the middle, the mean height from 0 to 1, and the square
  // root of the number of samples.
  Eigen::VectorXd places, heights, roots;
  // Weight of this edge in the estimate of the unsharp mask.
  double weight = 1;
};

// The parameters that fit one edge by itself.
struct EdgeFit {
  // Standard deviation of the Gaussian spread, px: that of the camera and that of the edge in the
  // world together.
  double spread_px = 1;
  // Standard error of the logarithm of the spread.
  double spread_error = 0;
  // Amount of the unsharp mask and its standard error; the error is 0 if the amount was given.
  double amount = 0, amount_error = 0;
  // Root mean square of the residuals, in heights from 0 to 1.
  double rms = 0;
};

// Fits each edge under an unsharp mask of the given radius (standard deviation, px). The unknowns
// of an edge are its place, its two plateaus, its spread and, if `amount` is empty, the amount of
// the mask. The method is Gauss-Newton, with place and plateaus eliminated by variable projection
// (Golub and Pereyra 1973). The result has one fit per edge, in order. `start`: fits of the same
// edges under another mask, from which the iterations begin; empty if there are none.
std::vector<EdgeFit> fit_edges(const std::vector<GatheredEdge>& edges,
                               double radius_px,
                               std::optional<double> amount,
                               const image::ToneCurve& tone,
                               const std::vector<EdgeFit>& start = {});

}  // namespace airtruth::optics
