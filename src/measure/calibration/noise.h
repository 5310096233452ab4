// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "measure/calibration/calibration.h"

namespace airtruth::calibration {

// Noise from flat blocks of pairs of frames. Which blocks are flat is decided in one frame of a
// pair and their variance taken from the other, so that the choice does not bias the value; a
// plane is taken off each block first.
class NoiseMeter {
 public:
  NoiseMeter(const image::Mask* own_aircraft, const image::ToneCurve& tone)
      : own_aircraft_(own_aircraft), tone_(tone) {}
  void add(const image::Picture& frame, const image::Picture& next);

  struct Result {
    Estimate gain, floor, correlation_px;
  };
  // Empty, with the reason in `why`, where there are too few flat blocks.
  std::optional<Result> result(std::string& why) const;
  std::vector<NoisePoint> points() const;

 private:
  struct Block {
    double luma = 0;        // 0..1, coded
    double variance = 0;    // code values squared, in the other frame
    double covariance = 0;  // with the neighbour to the right and below, mean of both
    double flatness = 0;    // variance in the frame that decides
  };
  std::vector<Block> chosen() const;

  const image::Mask* own_aircraft_;
  image::ToneCurve tone_;
  double codes_per_unit_ = 255;
  std::vector<Block> blocks_;
};

}  // namespace airtruth::calibration
