// SPDX-License-Identifier: Apache-2.0
#include "detection/scoring/share.h"

#include <vector>

#include <gtest/gtest.h>

#include "detection/scoring/assessment.h"

namespace airtruth::detection {
namespace {

// The limits are the roots of (p - x)^2 = z^2 x (1 - x) / n.
void expect_roots(double p, double n, const ShareInterval& interval) {
  const double z2 = 1.959963984540054 * 1.959963984540054;
  for (const double x : {interval.low, interval.high})
    EXPECT_NEAR((p - x) * (p - x), z2 * x * (1 - x) / n, 1e-12);
}

TEST(Share, WilsonsLimitsSolveHisEquation) {
  expect_roots(0.3, 10, wilson(3, 10));
  expect_roots(0.9, 40, wilson(36, 40));
  expect_roots(0, 5, wilson(0, 5));
  expect_roots(1, 5, wilson(5, 5));
  EXPECT_EQ(wilson(0, 5).low, 0);
  EXPECT_EQ(wilson(5, 5).high, 1);
  EXPECT_EQ(wilson(0, 0).low, 0);
  EXPECT_EQ(wilson(0, 0).high, 1);
}

// Newcombe 1998 (Statistics in Medicine 17, 857), table I: 81 of 263 gives 0.2553 to 0.3662, and
// 15 of 148 gives 0.0624 to 0.1605; 0 of 20 gives 0 to 0.1611.
TEST(Share, WilsonsLimitsAreThePublishedOnes) {
  EXPECT_NEAR(wilson(81, 263).low, 0.2553, 5e-5);
  EXPECT_NEAR(wilson(81, 263).high, 0.3662, 5e-5);
  EXPECT_NEAR(wilson(15, 148).low, 0.0624, 5e-5);
  EXPECT_NEAR(wilson(15, 148).high, 0.1605, 5e-5);
  EXPECT_NEAR(wilson(0, 20).high, 0.1611, 5e-5);
}

TEST(Share, TheExampleOfTheHeader) {
  const std::vector<Cluster> clusters = {{2, 2}, {0, 2}, {1, 2}, {2, 2}};
  const Share share = share_of(clusters);
  EXPECT_EQ(share.value, 0.625);
  EXPECT_EQ(share.trials, 8);
  EXPECT_EQ(share.clusters, 4);
  const double variance = 4.0 / 3 * 2.75 / 64;
  const double trials =
      0.625 * 0.375 / variance * (1.959963984540054 / 3.18245) * (1.959963984540054 / 3.18245);
  EXPECT_NEAR(trials, 1.55, 0.005);
  expect_roots(0.625, trials, {share.low, share.high});
}

// Frames that all agree within their sequence are no more than one trial each.
TEST(Share, CopiesOfAFrameAddNothing) {
  std::vector<Cluster> once;
  std::vector<Cluster> often;
  for (int i = 0; i < 40; ++i) {
    const double hit = i % 4 == 0 ? 1 : 0;
    once.push_back({hit, 1});
    often.push_back({100 * hit, 100});
  }
  EXPECT_NEAR(share_of(once).low, share_of(often).low, 1e-12);
  EXPECT_NEAR(share_of(once).high, share_of(often).high, 1e-12);
  // Nearly that of 10 of 40 independent trials.
  EXPECT_NEAR(share_of(once).low, wilson(10, 40).low, 0.01);
}

TEST(Share, AllFoundIsAsManyTrialsAsSequences) {
  const std::vector<Cluster> clusters = {{50, 50}, {50, 50}, {50, 50}};
  const Share share = share_of(clusters);
  EXPECT_EQ(share.high, 1);
  EXPECT_NEAR(share.low, wilson(3, 3).low, 1e-12);
  // By Kish's number, weights 1, 1 and 2 are worth 16 / 6 sequences.
  const Share weighted = share_of(std::vector<Cluster>{{50, 50, 1}, {50, 50, 1}, {50, 50, 2}});
  EXPECT_NEAR(weighted.low, wilson(16.0 / 6, 16.0 / 6).low, 1e-12);
}

TEST(Share, WeightsCount) {
  const Share share = share_of(std::vector<Cluster>{{1, 1, 3}, {0, 1, 1}});
  EXPECT_EQ(share.value, 0.75);
  EXPECT_EQ(share.successes, 3);
  EXPECT_EQ(share.trials, 4);
}

TEST(Share, NothingIsKnownWithoutATrial) {
  const Share share = share_of(std::vector<Cluster>{{0, 0}});
  EXPECT_EQ(share.trials, 0);
  EXPECT_EQ(share.low, 0);
  EXPECT_EQ(share.high, 1);
}

}  // namespace
}  // namespace airtruth::detection
