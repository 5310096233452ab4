// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "calibration/measured/measured.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

// The times of a shutter: for how long a row is exposed, and from the first row to the last.
namespace airtruth::sensor {

using measured::Measured;
using measured::NotMeasured;

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

// The motion of each frame of one shot from the frame before it (frame k from frame k - 1), in
// pixels. An entry is empty if the motion is not known, as for the first frame of a shot.
using Steps = std::vector<std::optional<Homography>>;

// The readout time of a rolling shutter as a share of the frame interval, positive if the sensor is
// read downwards. A rolling shutter shears and stretches the picture when the speed changes between
// frames: between neighbouring frames the shear is readout / height times the change of the
// horizontal speed, and the stretch is readout / height times the change of the vertical speed.
// `shots` has the steps of each shot. Not measured where too few motions are known, where the speed
// changes too little, where the shear is larger than a readout over a whole frame would cause, and
// where the sensor is read along the picture's rows, as that of a camera mounted on its side.
Measured<Estimate> readout_share(const std::vector<Steps>& shots, int width, int height);

}  // namespace airtruth::sensor
