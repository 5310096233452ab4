// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "camera/motion/motion.h"

namespace airtruth::motion {

// Rates of turning as a camera's gyroscope told them, about its own axes (whichever those are).
struct GyroSample {
  double time_s = 0;  // on the video's clock, but for an offset that is solved
  Vector3 rate_radps = Vector3::Zero();
};

// One packet of a GoPro's telemetry (GPMF: key, type, size and count, then values, big-endian,
// nested in DEVC and STRM), its samples spread evenly over [begin_s, end_s). Nothing where the
// packet has no GYRO or is damaged.
std::vector<GyroSample> gyro_from_gpmf(std::span<const std::uint8_t> packet,
                                       double begin_s,
                                       double end_s);

struct GyroFit {
  Quaternion cam_from_gyro = Quaternion::Identity();
  double offset_s = 0;                   // gyro time = video time + offset
  Vector3 bias_radps = Vector3::Zero();  // in cam
  double correlation = 0;                // of measured rates and the gyro's, 0..1
  double rms_radps = 0;
};

// Axes, offset and bias by which the gyro agrees best with measured rotations (least squares; axes
// by Kabsch 1976). Empty where fewer than 40 measured steps turn at all, or where the two do not
// agree (correlation below 0.5).
std::optional<GyroFit> fit_gyro(const std::vector<GyroSample>& gyro,
                                const std::vector<FrameMotion>& motion);

// Frames that were not measured, from the gyro, between those that were; the rest of the clip after
// a bridge follows on. They stay flagged as bridged.
std::vector<FrameMotion> bridged_by_gyro(const std::vector<FrameMotion>& motion,
                                         const std::vector<GyroSample>& gyro,
                                         const GyroFit& fit);

}  // namespace airtruth::motion
