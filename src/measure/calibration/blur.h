// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "foundation/geometry/transform.h"
#include "measure/calibration/calibration.h"

namespace airtruth::calibration {

// The derivative of evenly spaced samples at k, per step, up to near their Nyquist frequency: the
// ideal differentiator (-1)^(j + 1) / j under a Hann window. Camera shake at 10 Hz in 30 frames/s
// would lose half of its speed to a plain difference. Empty near the ends.
std::optional<Pixel> rate_at(const std::vector<Pixel>& places, std::size_t k);

// Exposure as a share of the frame interval. A frame taken in motion has lost detail along the
// motion and none across it. Its neighbour taken at rest shows the same scene: it is blurred along
// the same line until it has lost as much; that length over the speed is the share.
class BlurMeter {
 public:
  explicit BlurMeter(const image::Mask* own_aircraft) : own_aircraft_(own_aircraft) {}
  // Frames in order; the first few hundred are kept, cropped. `moved`: of the picture's middle
  // since the frame before, px; empty: not known.
  void add(const image::Picture& frame, const std::optional<Pixel>& moved);
  // The next frame begins a shot: it has no neighbour before it.
  void cut();
  std::optional<Estimate> share(std::string& why) const;

 private:
  struct Shot {
    std::vector<cv::Mat> crops;
    std::vector<Pixel> places;
    std::vector<bool> known;
  };
  // By how much of the interval frames of a shot are blurred; returns how many had a neighbour.
  static std::size_t add_shares(const Shot& shot, std::vector<double>& shares);
  const image::Mask* own_aircraft_;
  std::vector<Shot> shots_ = std::vector<Shot>(1);
  std::size_t frames_ = 0;
};

}  // namespace airtruth::calibration
