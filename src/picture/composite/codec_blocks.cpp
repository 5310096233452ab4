// SPDX-License-Identifier: Apache-2.0
#include "picture/composite/codec_blocks.h"

#include <algorithm>
#include <optional>

namespace airtruth::composite {
namespace {

// Side of a macroblock of H.264.
constexpr int kMacroblockPx = 16;

std::optional<PixelBox> bounds_of(const image::Coverage& coverage) {
  std::optional<PixelBox> found;
  each_pixel(coverage, [&](int x, int y, float share) {
    if (!(share > 0)) return;
    const PixelBox pixel{x, y, 1, 1};
    found = found ? bounds(*found, pixel) : pixel;
  });
  return found;
}

// The macroblocks that the box touches; empty outside the frame.
std::optional<PixelBox> in_macroblocks(const PixelBox& box, const image::Picture& frame) {
  const auto down = [](int v) { return std::max(0, v) / kMacroblockPx * kMacroblockPx; };
  const auto up = [&](int v) { return down(v + kMacroblockPx - 1); };
  const int x = down(box.x), y = down(box.y);
  const auto even = [](int size, int log2) { return size >> log2 << log2; };
  return intersection({x, y, up(box.right()) - x, up(box.bottom()) - y},
                      {0,
                       0,
                       even(frame.width, image::log2_chroma_width(frame.colour.chroma)),
                       even(frame.height, image::log2_chroma_height(frame.colour.chroma))});
}

// Adds a box and merges it with those that it overlaps.
void add_merged(std::vector<PixelBox>& boxes, PixelBox box) {
  for (std::size_t i = 0; i < boxes.size();) {
    if (!intersection(boxes[i], box)) {
      ++i;
      continue;
    }
    box = bounds(box, boxes[i]);
    boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(i));
    i = 0;
  }
  boxes.push_back(box);
}

}  // namespace

std::vector<CodedWindow> coded_windows(const image::Picture& background,
                                       const image::Layer& layer,
                                       int halo_px) {
  std::vector<PixelBox> boxes;
  const int reach = halo_px + kCodecBlockPx;
  for (const image::Coverage& coverage : layer.coverage) {
    const auto around = bounds_of(coverage);
    if (!around) continue;
    const auto window = in_macroblocks(wider(*around, reach), background);
    if (window) add_merged(boxes, *window);
  }
  std::vector<CodedWindow> windows;
  for (const PixelBox& box : boxes) windows.push_back({box, image::crop(background, box)});
  return windows;
}

std::vector<std::uint8_t> in_marked_blocks(const PixelBox& patch,
                                           const std::vector<std::uint8_t>& marked) {
  std::vector<std::uint8_t> result(marked.size(), 0);
  const auto first = [](int v) { return v / kCodecBlockPx * kCodecBlockPx; };
  for (int by = first(patch.y); by < patch.bottom(); by += kCodecBlockPx)
    for (int bx = first(patch.x); bx < patch.right(); bx += kCodecBlockPx) {
      const PixelBox block = *intersection({bx, by, kCodecBlockPx, kCodecBlockPx}, patch);
      bool any = false;
      for (int y = block.y; y < block.bottom(); ++y)
        for (int x = block.x; x < block.right(); ++x)
          any = any || marked[index_in(patch, x, y)] != 0;
      if (!any) continue;
      for (int y = block.y; y < block.bottom(); ++y)
        std::fill_n(&result[index_in(patch, block.x, y)], block.width, std::uint8_t{1});
    }
  return result;
}

}  // namespace airtruth::composite
