// SPDX-License-Identifier: Apache-2.0
#include "show/motion_plot/motion_plot.h"

#include <cmath>

#include <gmock/gmock.h>

namespace airtruth::motion_plot {
namespace {

using motion::FrameMotion;
using motion::State;

constexpr int kWidth = 1280, kHeight = 960;

// Frames whose picture is shifted by 10 px sin(0.1 k).
std::vector<FrameMotion> swaying(int count) {
  std::vector<FrameMotion> all(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    FrameMotion& motion = all[static_cast<std::size_t>(k)];
    motion.frame = k;
    motion.state = State::kMeasured;
    motion.frame_from_reference(0, 2) = 10 * std::sin(0.1 * k);
  }
  return all;
}

TEST(MotionPlot, OneFrameFarOffDoesNotPressTheOthersFlat) {
  std::vector<FrameMotion> all = swaying(300);
  all[150].frame_from_reference(0, 2) = 1.36e6;
  const plot::Plot centre = plots_of(all, kWidth, kHeight)[0];
  EXPECT_LT(*centre.y.max - *centre.y.min, 60);
  EXPECT_EQ(centre.title, "1 off the scale");
  const auto above = std::find_if(centre.series.begin(), centre.series.end(), [](const auto& s) {
    return s.mark == plot::Mark::kAbove;
  });
  ASSERT_NE(above, centre.series.end());
  EXPECT_THAT(above->x, testing::ElementsAre(150));
}

TEST(MotionPlot, NeighbouringUnmeasuredFramesAreOneBandAndCutsAnother) {
  std::vector<FrameMotion> all = swaying(20);
  all[4].state = all[5].state = State::kBridged;
  all[6].state = State::kCut;
  for (const plot::Plot& plot : plots_of(all, kWidth, kHeight)) {
    ASSERT_EQ(plot.bands.size(), 2U);
    EXPECT_EQ(plot.bands[0].from, 3.5);
    EXPECT_EQ(plot.bands[0].to, 5.5);
    EXPECT_EQ(plot.bands[1].from, 5.5);
    EXPECT_EQ(plot.bands[1].to, 6.5);
  }
}

TEST(MotionPlot, LineFollowsTheCentre) {
  const plot::Plot centre = plots_of(swaying(50), kWidth, kHeight)[0];
  ASSERT_EQ(centre.series[0].name, "centre, x");
  for (std::size_t k = 0; k < 50; ++k)
    EXPECT_NEAR(centre.series[0].y[k], 10 * std::sin(0.1 * static_cast<double>(k)), 1e-9) << k;
}

}  // namespace
}  // namespace airtruth::motion_plot
