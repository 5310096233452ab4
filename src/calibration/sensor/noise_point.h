// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace airtruth::calibration {

// Luma noise at one brightness: one of the points to which the noise curve is fitted.
struct NoisePoint {
  // Coded luma, 0 to 1.
  double luma = 0;
  // Standard deviation of the luma, code values.
  double sigma_codes = 0;
  // The number of flat blocks that the point stands for.
  int blocks = 0;
};

}  // namespace airtruth::calibration
