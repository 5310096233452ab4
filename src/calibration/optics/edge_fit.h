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

// An unsharp mask on coded luma: the picture plus `amount` times the difference between the picture
// and its Gaussian blur. `radius_px` is the standard deviation of the blur. Picture and blur are
// integrated over whole pixels.
class UnsharpMask {
 public:
  UnsharpMask(double amount, double radius_px);
  // The mask of the same radius with another amount.
  UnsharpMask with_amount(double amount) const;

 private:
  friend class StepModel;
  double amount_;
  // Kernel at the spacing of StepModel's places.
  std::vector<double> kernel_;
};

// The response of a camera to a step of light between two coded levels: a Gaussian spread in linear
// light, then the tone curve, then the unsharp mask. Heights are 0 and 1 far from the step. Places
// are in px from the middle of the coded step.
class StepModel {
 public:
  StepModel(double spread_px,
            const UnsharpMask& mask,
            double low,
            double high,
            const image::ToneCurve& tone);

  // The height at a place and its slope per px.
  std::pair<double, double> at(double place_px) const;

 private:
  friend class UnsharpMask;
  // Half the length of the table of heights, px: places beyond it have the height of its ends.
  static constexpr double kHalf = 9;
  // The number of table entries per pixel.
  static constexpr int kPerPixel = 10;
  // The number of table entries.
  static constexpr std::size_t kCount = 2 * static_cast<std::size_t>(kHalf) * kPerPixel + 1;
  void sharpen(const UnsharpMask& mask);
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
