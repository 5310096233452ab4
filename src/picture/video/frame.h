// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "foundation/image/picture.h"

namespace airtruth::video {

// One frame of a video with the decoder's own planes, upright (rotation metadata already applied,
// losslessly).
struct Frame {
  std::int64_t index = 0;    // from the first frame that the reader hands out
  std::int64_t pts = 0;      // in StreamInfo::time_base, as in the stream
  double time_s = 0;         // seconds from the first frame that the reader hands out
  bool begins_shot = false;  // after a cut (foundation/image/cuts.h); where it was asked for
  bool damaged = false;  // the decoder said that its data was corrupt, or concealed errors in it
  std::optional<double> quantiser;  // mean of H.264's QP over its blocks; where it was asked for
  image::Picture picture;
};

}  // namespace airtruth::video
