// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <stop_token>
#include <vector>

#include <opencv2/core.hpp>

#include "foundation/base/files.h"
#include "foundation/base/log.h"
#include "foundation/geometry/box.h"

namespace airtruth::match {

// A real aircraft's boxes by frame. The file is CSV with a header and the columns frame, x, y,
// width, height (or w, h), with frames from 0. `origin_px` is subtracted from x and y (1 for
// MATLAB's coordinates).
using RealBoxes = std::map<std::int64_t, Box>;
RealBoxes read_boxes(const fs::path& file, double origin_px);

// The real aircraft of a clip, as visible in one shot.
struct RealAircraft {
  RealBoxes boxes;                        // tight boxes by frame
  std::map<std::int64_t, cv::Mat> masks;  // of each box; 8-bit, 255: aircraft; kMaxMaskPx or less
  std::vector<std::int64_t> cuts;         // cuts of the clip
};
constexpr int kMaxMaskPx = 64;  // larger masks are reduced to this size

// Tight boxes within loose ones, in the shot that has most of them (cuts.h), from its first on for
// `most_frames` frames (0: all). Frames whose larger side strays by more than a quarter from the
// median of the 15 around it are left out. Error where fewer than five boxes are left: their
// aircraft does not stand out.
RealAircraft find_real(const fs::path& video,
                       const RealBoxes& loose,
                       std::int64_t most_frames,
                       const Warn& warn,
                       const std::stop_token& stop);

// A map by frame without what strays, as above.
RealBoxes without_jumps(const RealBoxes& boxes);

}  // namespace airtruth::match
