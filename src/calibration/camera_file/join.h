// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "calibration/camera_file/calibration.h"

// Combines the calibrations of several clips of one camera into one.
namespace airtruth::camera_file {

// The combination of several measurements of one quantity. If they agree, it is their mean weighted
// by inverse variance, with the error of that mean. They disagree if chi-square exceeds its mean by
// more than three of its standard deviations. Then the variance between the measurements is
// estimated (Paule and Mandel 1982) and added to every measurement's own variance in the weights.
// The error includes it too and is then the error of one further measurement. Example: 7.0 +- 0.5
// and 13.0 +- 0.5 make 10.0 +- 5.2.
struct Pooled {
  Estimate value;
  bool agree = true;
};
// `all` has one measurement or more. A measurement with an error of 0 is given the median error of
// the others.
Pooled pooled(std::vector<Estimate> all);

// Throws Error if the clips differ in picture size, or in frame rate by more than a hundredth.
void check_joinable(const std::vector<std::filesystem::path>& clips);

// Combines the values that belong to the camera: optics, sensor and shutter. Air and light belong
// to one flight and are left out. Values on which clips contradict one another have a
// `doubt`.
Calibration joined(std::vector<Calibration> clips);

}  // namespace airtruth::camera_file
