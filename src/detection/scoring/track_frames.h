// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <airtruth/box.h>

// True and reported tracks of a sequence, as HOTA, CLEAR and Identity take them.
namespace airtruth::detection {

struct TrackBox {
  std::int64_t id = 0;  // once a frame at most
  Box box_px;
};
struct TrackFrame {
  std::vector<TrackBox> truths;
  std::vector<TrackBox> answers;
};
using TrackFrames = std::vector<TrackFrame>;

}  // namespace airtruth::detection
