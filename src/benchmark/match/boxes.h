// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>

#include "foundation/geometry/box.h"

namespace airtruth::match {

namespace fs = std::filesystem;

// A real aircraft's boxes by frame. The file is CSV with a header and the columns frame, x, y,
// width, height (or w, h), with frames from 0. `origin_px` is subtracted from x and y (1 for
// MATLAB's coordinates).
using RealBoxes = std::map<std::int64_t, Box>;
RealBoxes read_boxes(const fs::path& file, double origin_px);

}  // namespace airtruth::match
