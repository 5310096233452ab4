// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace airtruth::calibration {

// A value and its standard error.
struct Estimate {
  double value = 0;
  double sigma = 0;
};

}  // namespace airtruth::calibration
