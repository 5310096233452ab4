// SPDX-License-Identifier: Apache-2.0
#include "labels/pixel_mask/pixel_mask.h"

#include "foundation/base/error.h"

namespace airtruth::pixel_mask {

exchange::PixelMask pixel_mask_of(int width,
                                  int height,
                                  const PixelBox& bounds,
                                  const std::function<bool(int x, int y)>& inside) {
  check(bounds.x >= 0 && bounds.y >= 0 && bounds.right() <= width && bounds.bottom() <= height,
        "a mask's bounds lie in its picture");
  std::vector<std::uint32_t> counts = {0};
  bool is_inside = false;
  const auto add = [&](bool next, std::uint32_t pixels) {
    if (pixels == 0) return;
    if (next != is_inside) counts.push_back(0);
    is_inside = next;
    counts.back() += pixels;
  };
  exchange::PixelMask mask{width, height, {}, 0};
  const auto column = static_cast<std::uint32_t>(height);
  add(false, column * static_cast<std::uint32_t>(bounds.x));
  for (int x = bounds.x; x < bounds.right(); ++x) {
    add(false, static_cast<std::uint32_t>(bounds.y));
    for (int y = bounds.y; y < bounds.bottom(); ++y) {
      const bool here = inside(x, y);
      mask.area_px += here ? 1 : 0;
      add(here, 1);
    }
    add(false, static_cast<std::uint32_t>(height - bounds.bottom()));
  }
  add(false, column * static_cast<std::uint32_t>(width - bounds.right()));
  mask.counts = compressed_counts(counts);
  return mask;
}

std::string compressed_counts(const std::vector<std::uint32_t>& counts) {
  std::string text;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    std::int64_t rest = counts[i];
    if (i > 2) rest -= counts[i - 2];
    for (bool more = true; more;) {
      auto group = static_cast<int>(rest & 0x1f);
      rest >>= 5;
      more = (group & 0x10) != 0 ? rest != -1 : rest != 0;
      if (more) group |= 0x20;
      text += static_cast<char>(group + 48);
    }
  }
  return text;
}

}  // namespace airtruth::pixel_mask
