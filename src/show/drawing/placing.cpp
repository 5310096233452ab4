// SPDX-License-Identifier: Apache-2.0
#include "show/drawing/placing.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

namespace airtruth::drawing {
namespace {

// The sizes of this file are display choices.

// Distance between a box's outline and its label, in pixels.
constexpr int kGapPx = 3;
// Number of rings of candidate places; a label of 10 px reaches 2,000 px with them.
constexpr int kRings = 200;

bool is_allowed(const PixelBox& place, const Placing& placing) {
  const PixelBox& frame = placing.frame;
  if (place.x < frame.x || place.y < frame.y || place.right() > frame.right() ||
      place.bottom() > frame.bottom())
    return false;
  return std::ranges::none_of(
      placing.taken, [&](const PixelBox& other) { return intersection(place, other).has_value(); });
}

// Places around `anchor` enlarged by `reach`. Above and below come first, since most aircraft are
// wider than tall.
std::array<PixelBox, 8> around(const PixelBox& anchor, int reach, int width, int height) {
  const int left = anchor.x - reach;
  const int right = anchor.right() + reach;
  const int above = anchor.y - reach - height;
  const int below = anchor.bottom() + reach;
  const int middle_y = anchor.y + (anchor.height - height) / 2;
  return {PixelBox{anchor.x, above, width, height},
          PixelBox{anchor.right() - width, above, width, height},
          PixelBox{anchor.x, below, width, height},
          PixelBox{anchor.right() - width, below, width, height},
          PixelBox{right, middle_y, width, height},
          PixelBox{left - width, middle_y, width, height},
          PixelBox{right, above, width, height},
          PixelBox{left - width, below, width, height}};
}

// The part of the anchor within the frame; its nearest pixel of the frame where there is none.
PixelBox inside(const PixelBox& anchor, const PixelBox& frame) {
  if (const auto common = intersection(anchor, frame)) return *common;
  return {std::clamp(anchor.x, frame.x, frame.right() - 1),
          std::clamp(anchor.y, frame.y, frame.bottom() - 1),
          1,
          1};
}

}  // namespace

std::optional<PixelBox> place_label(const PixelBox& anchor,
                                    int width,
                                    int height,
                                    const Placing& placing) {
  const PixelBox& frame = placing.frame;
  if (width > frame.width || height > frame.height || width <= 0 || height <= 0)
    return std::nullopt;
  const PixelBox seen = inside(anchor, frame);
  std::optional<PixelBox> best;
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  for (int ring = 0; ring < kRings; ++ring) {
    const int reach = kGapPx + ring * height;
    if (reach > std::max(frame.width, frame.height)) break;
    for (PixelBox place : around(seen, reach, width, height)) {
      place.x = std::clamp(place.x, frame.x, frame.right() - width);
      if (!is_allowed(place, placing)) continue;
      std::int64_t cost = 0;
      for (const PixelBox& box : placing.boxes) cost += common_px(place, box);
      if (cost == 0) return place;
      if (cost < least) {
        least = cost;
        best = place;
      }
    }
  }
  return best;
}

}  // namespace airtruth::drawing
