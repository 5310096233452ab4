// SPDX-License-Identifier: Apache-2.0
#include "labels/pixel_mask/pixel_mask.h"

#include <random>

#include <gtest/gtest.h>

namespace airtruth::pixel_mask {
namespace {

// The decoder of the published rules: groups of 5 bits become numbers, differences become counts,
// and counts become pixels down the columns.
std::vector<std::vector<bool>> decoded(const exchange::PixelMask& mask) {
  std::vector<std::int64_t> counts;
  for (std::size_t at = 0; at < mask.counts.size();) {
    std::int64_t number = 0;
    int bits = 0;
    for (bool more = true; more;) {
      const int group = mask.counts.at(at++) - 48;
      EXPECT_TRUE(group >= 0 && group < 64);
      number |= std::int64_t{group & 31} << bits;
      bits += 5;
      more = (group & 32) != 0;
      if (!more && (group & 16) != 0) number -= std::int64_t{1} << bits;
    }
    if (counts.size() > 2) number += counts[counts.size() - 2];
    counts.push_back(number);
  }
  std::vector<std::vector<bool>> pixels(static_cast<std::size_t>(mask.height),
                                        std::vector<bool>(static_cast<std::size_t>(mask.width)));
  std::size_t at = 0;
  bool inside = false;
  for (const std::int64_t count : counts) {
    EXPECT_GE(count, 0);
    for (std::int64_t k = 0; k < count; ++k, ++at)
      pixels.at(at % static_cast<std::size_t>(mask.height))
          .at(at / static_cast<std::size_t>(mask.height)) = inside;
    inside = !inside;
  }
  EXPECT_EQ(at, static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height));
  return pixels;
}

// Worked by hand. 3 x 3, the middle column inside:
// counts 3 3 3; the third is stored as it is: characters '3' each (48 + 3).
TEST(PixelMask, ThreeColumnsByHand) {
  const exchange::PixelMask mask = pixel_mask_of(3, 3, {1, 0, 1, 3}, [](int, int) { return true; });
  EXPECT_EQ(mask.counts, "333");
  EXPECT_EQ(mask.area_px, 3);
  // The first pixel is inside: 0 outside, 1 inside, 8 outside.
  EXPECT_EQ(pixel_mask_of(3, 3, {0, 0, 1, 1}, [](int, int) { return true; }).counts, "018");
  // 16 needs two groups, since the fifth bit is the sign: (16 | 32) + 48 is '`', then '0'.
  EXPECT_EQ(compressed_counts({16}), "`0");
  // The fourth count is less than the second: 1 - 3 = -2 is 0b11110 in five bits: 'N'.
  EXPECT_EQ(compressed_counts({2, 3, 4, 1}), "234N");
}

TEST(PixelMask, AnyMaskReadsBackByThePublishedRules) {
  std::mt19937 random(5);
  for (int round = 0; round < 60; ++round) {
    const int width = 1 + static_cast<int>(random() % 70);
    const int height = 1 + static_cast<int>(random() % 50);
    const int x = static_cast<int>(random() % static_cast<unsigned>(width));
    const int y = static_cast<int>(random() % static_cast<unsigned>(height));
    const PixelBox bounds{x,
                          y,
                          1 + static_cast<int>(random() % static_cast<unsigned>(width - x)),
                          1 + static_cast<int>(random() % static_cast<unsigned>(height - y))};
    const auto odds = 1 + random() % 7;
    std::vector<std::vector<bool>> wanted(static_cast<std::size_t>(height),
                                          std::vector<bool>(static_cast<std::size_t>(width)));
    std::int64_t area = 0;
    for (int v = bounds.y; v < bounds.bottom(); ++v)
      for (int u = bounds.x; u < bounds.right(); ++u) {
        const bool here = random() % 8 < odds;
        wanted[static_cast<std::size_t>(v)][static_cast<std::size_t>(u)] = here;
        area += here ? 1 : 0;
      }
    const exchange::PixelMask mask = pixel_mask_of(width, height, bounds, [&](int u, int v) {
      return wanted[static_cast<std::size_t>(v)][static_cast<std::size_t>(u)];
    });
    EXPECT_EQ(mask.area_px, area);
    ASSERT_EQ(decoded(mask), wanted) << width << " x " << height;
  }
}

}  // namespace
}  // namespace airtruth::pixel_mask
