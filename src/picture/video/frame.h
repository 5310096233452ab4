// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "foundation/image/picture.h"

namespace airtruth::video {

// One frame of a video in the decoder's own planes. The picture is upright: the rotation of the
// stream's metadata is already applied, without loss.
struct Frame {
  // Counts from the first frame that the reader hands out.
  std::int64_t index = 0;
  // Time stamp of the stream, in units of StreamInfo::time_base.
  std::int64_t pts = 0;
  // Seconds from the first frame that the reader hands out.
  double time_s = 0;
  // True for the first frame after a cut (foundation/image/cuts.h); needs ReaderOptions::with_cuts.
  bool begins_shot = false;
  // True where the decoder reported corrupt data or concealed errors in it.
  bool damaged = false;
  // Mean of H.264's QP over the frame's blocks; needs ReaderOptions::with_quantiser.
  std::optional<double> quantiser;
  image::Picture picture;
};

}  // namespace airtruth::video
