// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "foundation/base/log.h"
#include "foundation/image/layer.h"

namespace airtruth::calibration {

namespace fs = std::filesystem;

struct MaskOptions {
  std::stop_token stop;
  Warn warn;
  std::function<void(std::int64_t done, std::int64_t total)> progress;
};

// The own aircraft: what stays still in the picture while the world moves. Each pixel of pairs of
// frames is held against the same place, and against the place that the world has moved to; where
// the first fits and the second does not it is the aircraft, where the second fits alone it is the
// world, and where both do (evenly coloured parts) GrabCut (Rother, Kolmogorov and Blake 2004)
// decides by colour and edges. Black all through, as beyond a fisheye's circle, counts as aircraft.
// `found`: the share of the picture that is; Error where the video is too short or too still to
// tell.
image::Mask find_own_aircraft(const fs::path& video, const MaskOptions& options);

}  // namespace airtruth::calibration
