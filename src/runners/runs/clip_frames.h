// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "camera/motion/estimator.h"
#include "camera/motion/motion.h"
#include "foundation/base/log.h"
#include "picture/video/reader.h"
#include "runners/detector/detector.h"
#include "runners/runs/clips.h"

namespace airtruth::runs {

// The frames of a clip in order, with the camera's turn since the frame before, which is measured
// once for all detectors.
class ClipFrames {
 public:
  // Throws Error where the video cannot be read.
  ClipFrames(const DetectionClip& clip, bool with_motion, const Warn& warn);

  const detector::SequenceInput& sequence() const { return sequence_; }
  // The next frame of the clip; its picture is valid until the next call. Empty at the end. Throws
  // Error where the video ends before the clip does.
  std::optional<detector::FrameInput> next();
  // 0: unknown.
  std::int64_t count_estimate() const;

 private:
  std::optional<detector::CameraTurn> turn_of(const motion::FrameMotion& motion);

  const DetectionClip& clip_;
  video::Reader reader_;
  detector::SequenceInput sequence_;
  std::optional<motion::Estimator> estimator_;
  std::optional<video::Frame> frame_;
  std::optional<motion::FrameMotion> before_;
  std::int64_t index_ = 0;
};

}  // namespace airtruth::runs
