// SPDX-License-Identifier: Apache-2.0
#include "evaluation/statistics/proportion.h"

#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "evaluation/statistics/bootstrap.h"
#include "foundation/base/seed.h"

namespace airtruth::statistics {
namespace {

// The limits are the roots of (p - x)^2 = z^2 x (1 - x) / n.
void expect_roots(double p, double n, const evaluation::Interval& interval) {
  const double z2 = 1.959963984540054 * 1.959963984540054;
  for (const double x : {interval.low, interval.high})
    EXPECT_NEAR((p - x) * (p - x), z2 * x * (1 - x) / n, 1e-12);
}

TEST(Proportion, WilsonsLimitsSolveHisEquation) {
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
TEST(Proportion, WilsonsLimitsAreThePublishedOnes) {
  EXPECT_NEAR(wilson(81, 263).low, 0.2553, 5e-5);
  EXPECT_NEAR(wilson(81, 263).high, 0.3662, 5e-5);
  EXPECT_NEAR(wilson(15, 148).low, 0.0624, 5e-5);
  EXPECT_NEAR(wilson(15, 148).high, 0.1605, 5e-5);
  EXPECT_NEAR(wilson(0, 20).high, 0.1611, 5e-5);
}

TEST(Proportion, TheExampleOfTheHeader) {
  const std::vector<Cluster> clusters = {{2, 2}, {0, 2}, {1, 2}, {2, 2}};
  const Proportion share = proportion_of(clusters);
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
TEST(Proportion, CopiesOfAFrameAddNothing) {
  std::vector<Cluster> once;
  std::vector<Cluster> often;
  for (int i = 0; i < 40; ++i) {
    const double hit = i % 4 == 0 ? 1 : 0;
    once.push_back({hit, 1});
    often.push_back({100 * hit, 100});
  }
  EXPECT_NEAR(proportion_of(once).low, proportion_of(often).low, 1e-12);
  EXPECT_NEAR(proportion_of(once).high, proportion_of(often).high, 1e-12);
  // Nearly that of 10 of 40 independent trials.
  EXPECT_NEAR(proportion_of(once).low, wilson(10, 40).low, 0.01);
}

TEST(Proportion, AllFoundIsAsManyTrialsAsSequences) {
  const std::vector<Cluster> clusters = {{50, 50}, {50, 50}, {50, 50}};
  const Proportion share = proportion_of(clusters);
  EXPECT_EQ(share.high, 1);
  EXPECT_NEAR(share.low, wilson(3, 3).low, 1e-12);
  // By Kish's number, weights 1, 1 and 2 are worth 16 / 6 sequences.
  const Proportion weighted =
      proportion_of(std::vector<Cluster>{{50, 50, 1}, {50, 50, 1}, {50, 50, 2}});
  EXPECT_NEAR(weighted.low, wilson(16.0 / 6, 16.0 / 6).low, 1e-12);
}

TEST(Proportion, WeightsCount) {
  const Proportion share = proportion_of(std::vector<Cluster>{{1, 1, 3}, {0, 1, 1}});
  EXPECT_EQ(share.value, 0.75);
  EXPECT_EQ(share.successes, 3);
  EXPECT_EQ(share.trials, 4);
}

TEST(Proportion, TheWeightedExampleOfTheHeader) {
  const Proportion share = proportion_of(std::vector<Cluster>{{2, 2, 3}, {0, 2, 1}, {1, 2, 2}});
  EXPECT_NEAR(share.value, 2.0 / 3, 1e-12);
  EXPECT_NEAR(share.effective_clusters, 36.0 / 14, 1e-12);
  expect_roots(2.0 / 3, 1, {share.low, share.high});
}

// A sequence of nearly all the weight is hardly more than its own frames, whatever the others hold.
TEST(Proportion, OneHeavySequenceIsNotMany) {
  std::vector<Cluster> clusters = {{4, 4, 1000}};
  for (int i = 0; i < 50; ++i) clusters.push_back({i % 2 == 0 ? 4.0 : 0.0, 4, 1});
  const Proportion share = proportion_of(clusters);
  EXPECT_NEAR(share.effective_clusters, 1050.0 * 1050 / 1000050, 1e-9);
  // Kish's number of trials: (4 * 1050)^2 / (4 * 1000050) = 4.4.
  expect_roots(share.value, 4.0 * 1050 * 1050 / 1000050, {share.low, share.high});
  EXPECT_LT(share.low, 0.6);
}

// 60 sequences of 5 frames; a sequence is found with a chance of 0.3 or 0.8, and its weight is the
// ratio of the chance of its kind in the model (1/4, 3/4) to that in the set (1/2, 1/2). The
// model's share is 0.25 * 0.3 + 0.75 * 0.8.
TEST(Proportion, WeightedIntervalsHoldTheModelsShare) {
  const double truth = 0.25 * 0.3 + 0.75 * 0.8;
  Random random = Seed(3).stream("coverage");
  int holds = 0;
  double width = 0;
  double squares = 0;
  constexpr int kSets = 2000;
  for (int set = 0; set < kSets; ++set) {
    std::vector<Cluster> clusters;
    for (int i = 0; i < 60; ++i) {
      const bool hard = random.uniform() < 0.5;
      const bool found = random.uniform() < (hard ? 0.3 : 0.8);
      clusters.push_back({found ? 5.0 : 0.0, 5, hard ? 0.5 : 1.5});
    }
    const Proportion share = proportion_of(clusters);
    holds += share.low <= truth && truth <= share.high ? 1 : 0;
    width += (share.high - share.low) / kSets;
    squares += (share.value - truth) * (share.value - truth) / kSets;
  }
  EXPECT_NEAR(static_cast<double>(holds) / kSets, 0.95, 0.02);
  // As wide as the estimate scatters.
  EXPECT_NEAR(width, 2 * 1.96 * std::sqrt(squares), 0.1 * width);
}

// The percentile bootstrap of the ratio, with sequences of unequal lengths and weights.
TEST(Proportion, WeightedIntervalsAgreeWithTheBootstrap) {
  Random random = Seed(5).stream("bootstrap of a share");
  std::vector<Cluster> clusters;
  for (int i = 0; i < 300; ++i) {
    const double trials = 1 + std::floor(20 * random.uniform());
    const double chance = random.uniform() < 0.4 ? 0.2 : 0.9;
    clusters.push_back({std::round(chance * trials), trials, 0.2 + 2 * random.uniform()});
  }
  std::vector<double> values;
  ClusterDraws draws(clusters.size(), "test");
  for (int draw = 0; draw < 4000; ++draw) {
    const std::span<const double> counts = draws.next();
    double successes = 0;
    double trials = 0;
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      successes += counts[i] * clusters[i].weight * clusters[i].successes;
      trials += counts[i] * clusters[i].weight * clusters[i].trials;
    }
    values.push_back(successes / trials);
  }
  const evaluation::Interval bootstrap = percentile_interval(std::move(values));
  const Proportion share = proportion_of(clusters);
  const double width = bootstrap.high - bootstrap.low;
  EXPECT_NEAR(share.low, bootstrap.low, 0.08 * width);
  EXPECT_NEAR(share.high, bootstrap.high, 0.08 * width);
}

TEST(Proportion, NothingIsKnownWithoutATrial) {
  const Proportion share = proportion_of(std::vector<Cluster>{{0, 0}});
  EXPECT_EQ(share.trials, 0);
  EXPECT_EQ(share.low, 0);
  EXPECT_EQ(share.high, 1);
}

}  // namespace
}  // namespace airtruth::statistics
