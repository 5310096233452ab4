// SPDX-License-Identifier: Apache-2.0
#include "evaluation/measures/outcome.h"

#include <cmath>

#include <gtest/gtest.h>

namespace airtruth::measures {
namespace {

const Box kTruth{100, 100, 20, 10};
// Its columns with kTruth: 10 are shared, of 30.
const Box kHalf{110, 100, 20, 10};

TEST(Outcomes, AreOfFramesThatShowTheTarget) {
  const std::vector<evaluation::FramePair> pairs = {{kTruth, kTruth, 0},
                                                    {kTruth, kHalf, 0},
                                                    {std::nullopt, kTruth, 0},
                                                    {kTruth, std::nullopt, 0}};
  const lens::Lens lens = lens::pinhole_from_vertical_fov(60, {640, 480});
  const auto all = outcomes(pairs, &lens);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].centre_px, 10);
  EXPECT_DOUBLE_EQ(all[0].normalised.value(), 0.5);
  EXPECT_DOUBLE_EQ(all[0].overlap, 1.0 / 3);
  // The angle between the rays through x = 110 and 120 (y = 105), by the law of cosines.
  const double f = 240 / std::tan(std::acos(-1.0) / 6);
  const Vector3 a(110 - 320, 105 - 240, f);
  const Vector3 b(120 - 320, 105 - 240, f);
  EXPECT_NEAR(all[0].angle_mrad.value(), 1000 * std::acos(a.dot(b) / (a.norm() * b.norm())), 1e-5);
  EXPECT_EQ(all[1].frame, 3u);
  EXPECT_EQ(all[1].overlap, 0);
  // A lost frame has no centre error. The answer of the frame without the target is not its own.
  EXPECT_EQ(all[1].centre_px, std::nullopt);
  EXPECT_EQ(all[1].angle_mrad, std::nullopt);
  const Bin mean = mean_of(all);
  EXPECT_EQ(mean.centre_px, 10);
  EXPECT_EQ(mean.precision_20px, 0.5);
  EXPECT_EQ(mean_of(std::span(all).last(1)).centre_px, std::nullopt);
}

TEST(Breakdown, SortsIntoItsBins) {
  std::vector<Outcome> all(4);
  all[0].overlap = 1;
  all[1].overlap = 0.5;
  const std::vector<double> edges = {0, 10, 20};
  std::vector<std::optional<statistics::Place>> places;
  for (const std::optional<double> value : {std::optional(10.0), {10.0}, {25.0}, {}})
    places.push_back(statistics::place_of(value, edges));
  const auto bins = breakdown(all, places);
  ASSERT_EQ(bins.size(), 2u);
  EXPECT_EQ(bins[0].place.from, 10);
  EXPECT_EQ(bins[0].place.to, 20);
  EXPECT_EQ(bins[0].frames, 2);
  EXPECT_EQ(bins[0].overlap, 0.75);
  EXPECT_EQ(bins[0].success_50, 0.5);
  EXPECT_TRUE(std::isinf(bins[1].place.to));
}

}  // namespace
}  // namespace airtruth::measures
