// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "calibration/measured/measured.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

namespace airtruth::sensor {

using measured::Measured;
using measured::NotMeasured;

// The derivative of evenly spaced samples at index k, in pixels per sample. The filter is the ideal
// differentiator (-1)^(j + 1) / j under a Hann window, which is accurate to near the Nyquist
// frequency. A plain difference would lose half of the speed of a camera shake at 10 Hz in a video
// of 30 frames/s. Empty within 12 samples of either end.
std::optional<Pixel> rate_at(const std::vector<Pixel>& places, std::size_t k);

// Measures the exposure time as a share of the frame interval, 0 to 1, from motion blur. A frame
// taken in motion has lost detail along the motion and none across it. A neighbouring frame taken
// at rest shows the same scene. The meter blurs the neighbour along the line of motion until it has
// lost the same detail; the length of that blur divided by the speed in pixels per frame is the
// share.
class BlurMeter {
 public:
  explicit BlurMeter(const image::Mask* own_aircraft) : own_aircraft_(own_aircraft) {}
  // Adds the next frame of the clip. The meter keeps a crop of each of the first 300 frames and
  // ignores the others. `moved`: motion of the middle of the picture since the previous frame, px;
  // empty if it is not known.
  void add(const image::Picture& frame, const std::optional<Pixel>& moved);
  // Marks a cut: the next frame begins a shot and has no neighbour before it.
  void cut();
  // Not measured where too few moving frames have a neighbour at rest, where moving frames have
  // lost more detail than a whole interval of exposure explains, and where the exposure is too
  // short to measure.
  Measured<Estimate> share() const;

 private:
  struct Shot {
    std::vector<cv::Mat> crops;
    std::vector<Pixel> places;
    std::vector<bool> known;
  };
  // Appends the exposure share of each moving frame of `shot` to `shares`. Returns the number of
  // moving frames that have a neighbour at rest, measured or not.
  static std::size_t add_shares(const Shot& shot, std::vector<double>& shares);
  const image::Mask* own_aircraft_;
  std::vector<Shot> shots_ = std::vector<Shot>(1);
  std::size_t frames_ = 0;
};

}  // namespace airtruth::sensor
