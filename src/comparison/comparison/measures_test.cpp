// SPDX-License-Identifier: Apache-2.0
#include "comparison/comparison/measures.h"

#include <cmath>

#include <gtest/gtest.h>

namespace airtruth::comparison {
namespace {

TEST(Measures, MotionIsAgainstTheBackgroundAndUnsteadinessIsOffTheMiddle) {
  // The real one goes 3, 4 px a frame in a background that goes 3, 0; every third frame the
  // inserted one is 3 px off its line.
  std::vector<Compared> all(9);
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].frame = static_cast<std::int64_t>(10 + i);
    all[i].background_shift_px = Pixel(3, 0);
    all[i].real.centre_px = double(i) * Pixel(3, 4);
    all[i].made.centre_px = double(i) * Pixel(3, 4) + Pixel(i % 3 == 1 ? 3 : 0, 0);
  }
  for (const Pair& pair : pairs_of(all)) {
    if (pair.name.starts_with("motion")) {
      EXPECT_DOUBLE_EQ(pair.real, 4);
    }
    if (pair.name.starts_with("unsteadiness")) {
      EXPECT_NEAR(pair.real, 0, 1e-9);
      EXPECT_NEAR(pair.made, 1.5, 1e-9);  // 3, 1.5 and 1.5 in turn
    }
    if (pair.name.starts_with("edge")) {
      EXPECT_TRUE(std::isnan(pair.real));  // none is clear
    }
  }
}

}  // namespace
}  // namespace airtruth::comparison
