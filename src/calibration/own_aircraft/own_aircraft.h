// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stop_token>

#include "foundation/base/files.h"
#include "foundation/base/log.h"
#include "foundation/image/layer.h"

namespace airtruth::own_aircraft {

struct MaskOptions {
  std::stop_token stop;
  Warn warn;
  std::function<void(std::int64_t done, std::int64_t total)> progress;
};

// Finds the parts of the own aircraft that the camera sees: they stay still in the picture while
// the world moves. In pairs of frames each pixel is compared with the same place in the other frame
// and with the place to which the world has moved. If only the first agrees, the pixel shows the
// aircraft; if only the second agrees, it shows the world. If both agree, as in evenly coloured
// areas, GrabCut (Rother, Kolmogorov and Blake 2004) decides by colour and edges. Pixels that are
// black in the whole clip, as beyond the image circle of a fisheye lens, count as aircraft.
//
// The mask has the size of the video. It is empty if less than a thousandth of the picture is
// certainly aircraft. Throws Error if the video is too short or too still to separate the two.
image::Mask find_own_aircraft(const fs::path& video, const MaskOptions& options);

}  // namespace airtruth::own_aircraft
