// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "camera/motion/motion.h"

namespace airtruth::gyro {

// One measurement of a camera's gyroscope: the rates of rotation about the axes of the gyroscope,
// whose directions in the camera are unknown.
struct GyroSample {
  // The time on the video's clock, apart from an offset that fit_gyro() estimates.
  double time_s = 0;
  Vector3 rate_radps = Vector3::Zero();
};

// One packet of a GoPro's telemetry (gpmf.h). The samples are spread evenly over [begin_s, end_s).
// The result is empty where the packet has no GYRO or is damaged.
std::vector<GyroSample> gyro_from_gpmf(std::span<const std::uint8_t> packet,
                                       double begin_s,
                                       double end_s);

struct GyroFit {
  Quaternion cam_from_gyro = Quaternion::Identity();
  double offset_s = 0;  // gyro time = video time + offset
  // Standard error of the offset: the rates' residual over their change with time.
  double offset_sigma_s = 0;
  Vector3 bias_radps = Vector3::Zero();  // in cam
  double correlation = 0;                // of measured rates and the gyro's, 0..1
  double rms_radps = 0;
};

// The offsets among which one is looked for, in seconds.
struct OffsetRange {
  double from_s = -0.5;
  double to_s = 0.5;
};

// The axes, offset and bias with which the gyroscope fits the measured rotations best (least
// squares; axes by Kabsch 1976). The result is empty where fewer than 40 measured steps contain a
// rotation, or where the correlation is below 0.5.
std::optional<GyroFit> fit_gyro(const std::vector<GyroSample>& gyro,
                                const std::vector<motion::FrameMotion>& motion,
                                const OffsetRange& range = {});

// The best fit whose offset is at least `apart_s` from that of `best`: where it correlates nearly
// as well, the offset is ambiguous. Empty where nothing fits.
std::optional<GyroFit> other_fit(const std::vector<GyroSample>& gyro,
                                 const std::vector<motion::FrameMotion>& motion,
                                 const OffsetRange& range,
                                 const GyroFit& best,
                                 double apart_s);

// The motion with the turn of unmeasured frames, and of frames that begin anew, replaced by the
// gyroscope's. Measured frames continue from the frames that they are measured against. All frames
// keep their states.
std::vector<motion::FrameMotion> bridged_by_gyro(const std::vector<motion::FrameMotion>& motion,
                                                 const std::vector<GyroSample>& gyro,
                                                 const GyroFit& fit);

}  // namespace airtruth::gyro
