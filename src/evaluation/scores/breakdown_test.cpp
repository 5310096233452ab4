// SPDX-License-Identifier: Apache-2.0
#include "evaluation/scores/breakdown.h"

#include <limits>

#include <gtest/gtest.h>

namespace airtruth::scores {
namespace {

using Places = std::vector<std::optional<Place>>;

Places in_bins(const std::vector<std::optional<double>>& values) {
  const std::vector<double> edges = {100, 200, 300};
  Places places;
  for (const auto& value : values) places.push_back(place_of(value, edges));
  return places;
}

const Place kAbove = {.name = "above"};
const Place kBelow = {.name = "below"};

TEST(Breakdown, BinsHoldTheirLowerEdge) {
  const std::vector<AircraftInFrame> sightings = {
      {0, 0, 0, true}, {0, 1, 0, false}, {1, 0, 0, true}, {1, 1, 0, true}, {1, 2, 0, false}};
  const auto bins = detection_by(sightings, in_bins({100, 199.9, 200, 5000, std::nullopt}), {});
  ASSERT_EQ(bins.size(), 3u);
  EXPECT_EQ(bins[0].place.from, 100);
  EXPECT_EQ(bins[0].place.to, 200);
  EXPECT_EQ(bins[0].detection.value, 0.5);
  EXPECT_EQ(bins[0].detection.trials, 2);
  EXPECT_EQ(bins[1].detection.value, 1);
  EXPECT_EQ(bins[2].place.from, 300);
  EXPECT_FALSE(bins[2].weighted);
  EXPECT_EQ(bins[2].place.to, std::numeric_limits<double>::infinity());
  const auto by_name =
      detection_by(sightings, Places{kAbove, kAbove, kBelow, std::nullopt, kBelow}, {});
  ASSERT_EQ(by_name.size(), 2u);
  EXPECT_EQ(by_name[0].place.name, "above");
  EXPECT_EQ(by_name[0].detection.value, 0.5);
  EXPECT_EQ(by_name[1].detection.value, 0.5);
}

// Two sequences at 100 to 200 m: 1 of 2 found with a weight of 3, 1 of 1 with a weight of 1. Plain
// 2 of 3; weighted (3 * 1 + 1 * 1) / (3 * 2 + 1 * 1) = 4/7. Beyond 200 m only the second: 0 of 1.
TEST(Breakdown, WeightedSharesByHand) {
  const std::vector<AircraftInFrame> sightings = {
      {0, 0, 0, true}, {0, 1, 0, false}, {1, 0, 0, true}, {1, 1, 0, false}};
  const std::vector<double> weights = {3, 1};
  const auto bins = detection_by(sightings, in_bins({150, 160, 170, 250}), weights);
  ASSERT_EQ(bins.size(), 2u);
  EXPECT_NEAR(bins[0].detection.value, 2.0 / 3, 1e-12);
  ASSERT_TRUE(bins[0].weighted);
  EXPECT_NEAR(bins[0].weighted->value, 4.0 / 7, 1e-12);
  EXPECT_NEAR(bins[0].weighted->trials, 7, 1e-12);
  EXPECT_EQ(bins[0].weighted->clusters, 2);
  EXPECT_NEAR(bins[0].weighted->effective_clusters, 16.0 / 10, 1e-12);
  EXPECT_LT(bins[0].weighted->low, 4.0 / 7);
  EXPECT_GT(bins[0].weighted->high, 4.0 / 7);
  ASSERT_TRUE(bins[1].weighted);
  EXPECT_EQ(bins[1].weighted->value, 0);
  // Of all: (3 * 1 + 1 * 1) / (3 * 2 + 1 * 2).
  statistics::TrialsBySequence all;
  for (const AircraftInFrame& one : sightings) all.add(one.sequence, one.is_detected);
  EXPECT_EQ(all.proportion().value, 0.5);
  EXPECT_EQ(all.proportion(weights).value, 0.5);
  const auto by_name = detection_by(sightings, Places{kAbove, kBelow, kAbove, kBelow}, weights);
  EXPECT_EQ(by_name[0].weighted->value, 1);
  EXPECT_EQ(by_name[1].weighted->value, 0);
}

// A sequence that the model never has says nothing of it.
TEST(Breakdown, NoWeightIsNoShare) {
  const std::vector<AircraftInFrame> sightings = {{0, 0, 0, true}, {1, 0, 0, true}};
  const auto bins = detection_by(sightings, in_bins({150, 250}), std::vector<double>{1, 0});
  EXPECT_TRUE(bins[0].weighted);
  EXPECT_EQ(bins[1].detection.value, 1);
  EXPECT_FALSE(bins[1].weighted);
}

}  // namespace
}  // namespace airtruth::scores
