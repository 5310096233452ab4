// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "camera/gyro/gyro.h"
#include "camera/motion/motion.h"
#include "scene/flight_log/flight_log.h"

// The offset between a log's clock and a clip's, from the turns that both show.
namespace airtruth::flight_log {

// The log's turn rates; where it has none, those that its attitudes imply. Lists of fewer than 100
// a second are interpolated linearly to that, so that each frame of a clip has some.
std::vector<gyro::GyroSample> gyro_samples(const FlightLog& log);

// Fits whose offsets differ by more than this are different answers, seconds.
inline constexpr double kApartS = 1;

struct Alignment {
  std::optional<gyro::GyroFit> fit;
  // The correlation of the best fit further away than kApartS; 0 where nothing fits there.
  double other_correlation = 0;
  // Why there is no fit: one line.
  std::string why;
};

// Looks for the offset over the whole log, which may begin or end with the clip. There is no fit
// where the log does not cover the clip, where the log and the measured rotation do not correlate,
// where another offset fits nearly as well, or where the clip turns so little that the offset is
// uncertain by more than 0.1 s.
Alignment aligned(const std::vector<gyro::GyroSample>& rates,
                  const std::vector<motion::FrameMotion>& motion);

}  // namespace airtruth::flight_log
