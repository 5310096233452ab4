// SPDX-License-Identifier: Apache-2.0
#include "foundation/image/cuts.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace airtruth::image {
namespace {

// The frames that begin a shot, from 1 on. differences[k]: of frame k to frame k + 1.
std::vector<std::int64_t> cuts_of(const std::vector<double>& differences) {
  std::vector<std::int64_t> cuts;
  for (std::size_t i = 0; i < differences.size(); ++i)
    if (is_cut(differences, i)) cuts.push_back(static_cast<std::int64_t>(i) + 1);
  return cuts;
}

TEST(Cuts, OneFrameThatDiffersIsACutAndAPanIsNone) {
  EXPECT_EQ(cuts_of({0.1, 0.2, 40, 0.1, 0.2}), std::vector<std::int64_t>{3});
  EXPECT_TRUE(cuts_of({0.1, 8, 9, 8, 0.2}).empty());      // a fast pan
  EXPECT_TRUE(cuts_of({0.1, 0.2, 4, 0.1, 0.2}).empty());  // the camera is knocked
  EXPECT_TRUE(cuts_of({0.1, 20, 20, 0.1, 0.2}).empty());  // a flash: there and back
  EXPECT_TRUE(cuts_of(std::vector<double>{}).empty());
}

TEST(Cuts, TheDifferenceIsOfMeansByCell) {
  // At 64 x 48 pixels a cell has 2 x 2 pixels, so a checkerboard of single pixels is uniform over
  // cells.
  const auto picture = [](int even, int odd) {
    Picture p = make_picture(64, 48, {});
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x)
        p.planes[0].row(y)[x] = static_cast<std::uint8_t>((x + y) % 2 == 0 ? even : odd);
    return p;
  };
  Differences differences;
  EXPECT_FALSE(differences.add(picture(100, 120)));
  EXPECT_NEAR(*differences.add(picture(120, 100)), 0, 1e-12);
  EXPECT_NEAR(*differences.add(picture(120, 107)), 3.5, 1e-12);
}

// The cells have unequal widths (100 = 32 x 3.125), and each pixel lies in exactly one cell.
TEST(Cuts, EveryPixelIsInOneCell) {
  for (const int width : {5, 31, 32, 33, 100, 641}) {
    Picture one = make_picture(width, 30, {}), other = make_picture(width, 30, {});
    for (int y = 0; y < 30; ++y) {
      std::fill_n(one.planes[0].row(y), width, std::uint8_t{10});
      std::fill_n(other.planes[0].row(y), width, std::uint8_t{30});
    }
    Differences differences;
    differences.add(one);
    const double cells = std::min(width, 32) / 32.0;  // a narrow picture leaves some cells empty
    EXPECT_NEAR(*differences.add(other), 20 * cells, 1e-9) << width;
  }
}

// A cell of such a picture has more rows than 16-bit sums of white hold.
TEST(Cuts, ATallPictureHasTheSameMeans) {
  constexpr int kHeight = 24 * 300 + 7;
  const auto picture = [](std::uint8_t level) {
    Picture p = make_picture(40, kHeight, {});
    for (int y = 0; y < kHeight; ++y) std::fill_n(p.planes[0].row(y), 40, level);
    return p;
  };
  Differences differences;
  differences.add(picture(255));
  EXPECT_NEAR(*differences.add(picture(5)), 250, 1e-9);
}

}  // namespace
}  // namespace airtruth::image
