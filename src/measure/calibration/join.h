// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "foundation/base/log.h"
#include "measure/calibration/calibration.h"

// Several clips of one camera measured as one.
namespace airtruth::calibration {

// What several measurements of one quantity say together. Where they agree, their mean by inverse
// variance and its error. Where they differ by more than their errors allow (chi-square beyond its
// mean by three of its standard deviations), something that no error tells differs between them:
// its variance is estimated (Paule and Mandel 1982), the weights have it too, and so has the error,
// which is then that of one more measurement. Example: 7.0 +- 0.5 and 13.0 +- 0.5 make 10.0 +- 5.2.
struct Pooled {
  Estimate value;
  bool agree = true;
};
// At least one; an error of 0 counts as the median of the others' errors.
Pooled pooled(std::vector<Estimate> all);

// Error where the clips differ in size or frame rate (by more than a hundredth).
void check_joinable(const std::vector<std::filesystem::path>& clips, const Warn& warn);

// The camera's own values from all clips: optics, sensor, shutter. Air and light are of one flight
// and are left out. Values that clips contradict one another about are in `doubts`.
Calibration joined(std::vector<Calibration> clips);

}  // namespace airtruth::calibration
