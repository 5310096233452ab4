// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calibration/measured/measured.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "foundation/image/tone_curve.h"

namespace airtruth::sensor {

using measured::Measured;
using measured::NotMeasured;

// Luma noise at one brightness: one of the points to which the noise curve is fitted.
struct NoisePoint {
  // Coded luma, 0 to 1.
  double luma = 0;
  // Standard deviation of the luma, code values.
  double sigma_codes = 0;
  // The number of flat blocks that the point stands for.
  int blocks = 0;
};

// Measures luma noise in flat blocks of pairs of frames. One frame of a pair decides which blocks
// are flat and the other frame gives their variance, so that the selection does not bias the value.
// A plane is subtracted from each block first.
class NoiseMeter {
 public:
  NoiseMeter(const image::Mask* own_aircraft, const image::ToneCurve& tone)
      : own_aircraft_(own_aircraft), tone_(tone) {}
  // Adds a pair of consecutive frames.
  void add(const image::Picture& frame, const image::Picture& next);

  struct Result {
    Estimate gain, floor, correlation_px;
  };
  // Not measured where there are flat blocks of fewer than two brightnesses.
  Measured<Result> result() const;
  // The noise by brightness, to which result() fits the noise curve.
  std::vector<NoisePoint> points() const;

 private:
  struct Block {
    // Coded luma, 0 to 1.
    double luma = 0;
    // Variance in the frame that is measured, squared code values.
    double variance = 0;
    // Mean of the covariances with the right and with the lower neighbour, squared code values.
    double covariance = 0;
    // Variance in the frame that decides about flatness, squared code values.
    double flatness = 0;
  };
  // The flattest blocks of each brightness.
  std::vector<Block> chosen() const;
  // Standard deviation, px, of the Gaussian under which white noise has the blocks' correlation
  // between neighbouring pixels; 0 +- 1 where too few blocks are noisier than rounding.
  Estimate correlation_px() const;

  const image::Mask* own_aircraft_;
  image::ToneCurve tone_;
  double codes_per_unit_ = 255;
  std::vector<Block> blocks_;
};

}  // namespace airtruth::sensor
