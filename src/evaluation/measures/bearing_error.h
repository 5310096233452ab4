// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <airtruth/statistics.h>

// Errors of the bearings that detections give, beside those of a model of an electro-optical
// sensor.
namespace airtruth::measures {

// The EO/IR sensor of RTCA SC-228's studies as MIT Lincoln Laboratory states it (degas-core,
// EOIRParametricModel): standard deviations of azimuth and elevation, and of their rates.
constexpr double kSc228Bearing_mrad = 1.0;
constexpr double kSc228Rate_mradps = 1.4;

// The bearing of the detection's centre less that of the aircraft's reference point, at one frame.
// Azimuth is on the great circle: multiplied by the cosine of the elevation.
struct BearingSample {
  std::size_t sequence = 0;
  std::int64_t object = 0;  // TruthObject::id of the truth
  double time_s = 0;
  double azimuth_mrad = 0;
  double elevation_mrad = 0;
};

struct Spread {
  double mean = 0;
  double deviation = 0;  // standard deviation about the mean, n - 1
  double rms = 0;
  // The 95th percentile of the absolute value.
  double within_95 = 0;
  std::int64_t count = 0;
  // 95 % intervals of the four by the percentile bootstrap over sequences (statistics/bootstrap.h);
  // empty where fewer than two sequences have a value.
  std::optional<evaluation::Interval> mean_interval, deviation_interval;
  std::optional<evaluation::Interval> rms_interval, within_95_interval;
};

struct BearingError {
  // mrad
  Spread azimuth, elevation;
  // mrad/s: the change of the error over kRateBase_s of the same object, over that time. The
  // camera's own motion is in both bearings and drops out.
  std::optional<Spread> azimuth_rate, elevation_rate;
};
constexpr double kRateBase_s = 1;  // long beside the jitter of a box from frame to frame

// Samples of one object of one sequence are in order of time. Empty for no sample.
std::optional<BearingError> bearing_error(std::span<const BearingSample> samples);

}  // namespace airtruth::measures
