// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "camera/lens/lens.h"
#include "camera/motion/motion.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

namespace airtruth::motion {

// Measures the motion frame by frame, in order. Its memory does not grow with the number of frames.
// Only one thread at a time may use an Estimator.
class Estimator {
 public:
  // Model homography.
  Estimator(int width, int height, const image::Mask* own_aircraft = nullptr);
  // Model rotation.
  Estimator(const lens::Lens& lens,
            const Options& options,
            const image::Mask* own_aircraft = nullptr);
  ~Estimator();
  Estimator(Estimator&&) noexcept;
  // The motion of the next frame against the first frame. The model homography reads luma alone.
  // A `damaged` frame is bridged. A frame that begins a shot (foundation/image/cuts.h) is a
  // cut, unless most corners are tracked into it; this happens when an object suddenly covers a
  // part of the view.
  FrameMotion next(const image::Picture& picture,
                   double time_s,
                   bool damaged = false,
                   bool begins_shot = false);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace airtruth::motion
