// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "foundation/image/tone_curve.h"
#include "measure/measured/estimate.h"
#include "measure/sensor/noise_point.h"

namespace airtruth::calibration {

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
  // Empty, with the reason in `why`, where there are too few flat blocks.
  std::optional<Result> result(std::string& why) const;
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
  std::vector<Block> chosen() const;

  const image::Mask* own_aircraft_;
  image::ToneCurve tone_;
  double codes_per_unit_ = 255;
  std::vector<Block> blocks_;
};

}  // namespace airtruth::calibration
