// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include <airtruth/error.h>
#include <airtruth/statistics.h>
#include <gtest/gtest.h>

#include "foundation/base/seed.h"

namespace airtruth::evaluation {
namespace {

TEST(Bootstrap, OfTwoValuesIsBetweenThem) {
  // Both draws are the first value, both are the second, or they are mixed, with probabilities of
  // 1/4, 1/4 and 1/2.
  const auto interval = bootstrap_mean(std::vector<double>{1, 3});
  ASSERT_TRUE(interval);
  EXPECT_EQ(interval->low, 1);
  EXPECT_EQ(interval->high, 3);
  EXPECT_FALSE(bootstrap_mean(std::vector<double>{1}));
}

TEST(Bootstrap, OfManyIsThatOfTheNormal) {
  Random random(3);
  std::vector<double> values;
  for (int i = 0; i < 400; ++i) values.push_back(5 + 2 * random.normal());
  double mean = 0;
  for (const double v : values) mean += v / 400;
  double variance = 0;
  for (const double v : values) variance += (v - mean) * (v - mean) / 400;
  const auto interval = bootstrap_mean(values);
  ASSERT_TRUE(interval);
  const double half = 1.96 * std::sqrt(variance / 400);
  EXPECT_NEAR(interval->low, mean - half, 0.05 * half);
  EXPECT_NEAR(interval->high, mean + half, 0.05 * half);
}

TEST(Bootstrap, WeighsAsTold) {
  const std::vector<double> values = {0, 10};
  const auto interval = bootstrap_mean(values, std::vector<double>{1, 0});
  // Every draw that contains the first value has a mean of 0. A draw of the second alone has no
  // weight.
  ASSERT_TRUE(interval);
  EXPECT_EQ(interval->low, 0);
  EXPECT_EQ(interval->high, 0);
}

// About nineteen of twenty 95 % intervals contain the true mean.
TEST(Bootstrap, HoldsTheMeanAsOftenAsItSays) {
  Random random(7);
  int held = 0;
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> values;
    for (int i = 0; i < 40; ++i) values.push_back(random.normal());
    const auto interval = bootstrap_mean(values);
    held += interval->low <= 0 && interval->high >= 0 ? 1 : 0;
  }
  EXPECT_GE(held, 180);
  EXPECT_LE(held, 198);
}

TEST(Paired, ByHand) {
  // The differences are 1, 1, 1, 0. Of 16 sign changes, the 4 in which all three signs are equal
  // are as far from 0.
  const Paired p = paired(std::vector<double>{2, 3, 4, 5}, std::vector<double>{1, 2, 3, 5});
  EXPECT_DOUBLE_EQ(p.difference, 0.75);
  EXPECT_DOUBLE_EQ(p.p_value, 0.25);
  EXPECT_EQ(p.wins, 3);
  EXPECT_EQ(p.ties, 1);
  const Paired none = paired({}, {});
  EXPECT_EQ(none.p_value, 1);
  EXPECT_FALSE(none.interval);
}

TEST(Paired, OfManyAgreesWithAllSignsOfFew) {
  // For 17 values the signs are random; for 16 all are enumerated. The seventeenth value changes
  // nothing.
  std::vector<double> a;
  Random random(5);
  for (int i = 0; i < 16; ++i) a.push_back(0.3 + random.normal());
  const double exact = paired(a, std::vector<double>(16, 0)).p_value;
  a.push_back(0);
  EXPECT_NEAR(paired(a, std::vector<double>(17, 0)).p_value, exact, 0.015);
}

TEST(KendallTau, ByHand) {
  const std::vector<double> a = {1, 2, 3, 4};
  EXPECT_EQ(kendall_tau(a, a), 1);
  EXPECT_EQ(kendall_tau(a, std::vector<double>{4, 3, 2, 1}), -1);
  EXPECT_DOUBLE_EQ(*kendall_tau(a, std::vector<double>{1, 2, 4, 3}), 4.0 / 6);
  // With one tie, 5 pairs agree, of 6 and 5.
  EXPECT_DOUBLE_EQ(*kendall_tau(a, std::vector<double>{1, 2, 3, 3}), 5 / std::sqrt(30.0));
  EXPECT_FALSE(kendall_tau(a, std::vector<double>{1, 1, 1, 1}));
  EXPECT_FALSE(kendall_tau({}, {}));
}

TEST(Statistics, ListsOfOtherLengthsAreErrorsOfTheArgument) {
  const std::vector<double> three = {1, 2, 3}, two = {1, 2};
  EXPECT_THROW(bootstrap_mean(three, two), Error);
  EXPECT_THROW(paired(three, two), Error);
  EXPECT_THROW(kendall_tau(three, two), Error);
}

}  // namespace
}  // namespace airtruth::evaluation
