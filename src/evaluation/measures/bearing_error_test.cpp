// SPDX-License-Identifier: Apache-2.0
#include "evaluation/measures/bearing_error.h"

#include <cmath>

#include <gtest/gtest.h>

#include "foundation/base/seed.h"

namespace airtruth::measures {
namespace {

TEST(BearingError, MeansDeviationsAndRates) {
  // Errors of 1, 3 and 2 mrad at 0, 1 and 2 s: rates of 2 and -1 mrad/s. The sample of the other
  // sequence has none to compare with.
  const std::vector<BearingSample> samples = {
      {0, 1, 0, 1, 0}, {0, 1, 1, 3, 0}, {0, 1, 2, 2, 0}, {1, 1, 1, 2, 4}};
  const auto error = bearing_error(samples);
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->azimuth.mean, 2, 1e-12);
  EXPECT_NEAR(error->azimuth.deviation, std::sqrt(2.0 / 3), 1e-12);
  EXPECT_NEAR(error->azimuth.rms, std::sqrt(18.0 / 4), 1e-12);
  EXPECT_EQ(error->elevation.count, 4);
  EXPECT_NEAR(error->elevation.mean, 1, 1e-12);
  // Sorted 0 0 0 4: at 2.85 between the last two.
  EXPECT_NEAR(error->elevation.within_95, 0.85 * 4, 1e-12);
  ASSERT_TRUE(error->azimuth_rate);
  EXPECT_EQ(error->azimuth_rate->count, 2);
  EXPECT_NEAR(error->azimuth_rate->mean, 0.5, 1e-12);
  EXPECT_NEAR(error->azimuth_rate->deviation, std::sqrt(4.5), 1e-12);
  EXPECT_FALSE(bearing_error({}));
}

TEST(BearingError, ARateNeedsASampleASecondBefore) {
  const std::vector<BearingSample> samples = {
      {0, 1, 0, 1, 0}, {0, 1, 0.5, 3, 0}, {0, 1, 1.25, 3, 0}};
  EXPECT_FALSE(bearing_error(samples)->azimuth_rate);
  const std::vector<BearingSample> near = {{0, 1, 0, 1, 0}, {0, 1, 1.05, 2.05, 0}};
  EXPECT_NEAR(bearing_error(near)->azimuth_rate->mean, 1, 1e-12);
}

// With two sequences of one sample each, a quarter of the draws holds the one twice, a quarter the
// other: the ends of the interval. 1 and 4 mrad: means 1 to 4, deviations 0 to 3 / sqrt(2).
TEST(BearingError, TheIntervalOfTwoSequences) {
  const std::vector<BearingSample> samples = {{0, 1, 0, 1, 0}, {1, 1, 0, 4, 0}};
  const auto error = bearing_error(samples);
  ASSERT_TRUE(error->azimuth.mean_interval);
  EXPECT_NEAR(error->azimuth.mean_interval->low, 1, 1e-12);
  EXPECT_NEAR(error->azimuth.mean_interval->high, 4, 1e-12);
  EXPECT_NEAR(error->azimuth.deviation_interval->low, 0, 1e-12);
  EXPECT_NEAR(error->azimuth.deviation_interval->high, 3 / std::sqrt(2), 1e-12);
  EXPECT_NEAR(error->azimuth.within_95_interval->low, 1, 1e-12);
  EXPECT_NEAR(error->azimuth.within_95_interval->high, 4, 1e-12);
  EXPECT_FALSE(bearing_error(std::vector<BearingSample>{samples[0]})->azimuth.mean_interval);
}

// Normal errors with a deviation of 2 mrad: the mean of n has the deviation 2 / sqrt(n), and the
// deviation 2 / sqrt(2 n). Copies of a sample within its sequence add nothing.
TEST(BearingError, IntervalsAreThoseOfNormalErrors) {
  constexpr int kSequences = 400;
  Random random = Seed(7).stream("normal errors");
  std::vector<BearingSample> once;
  std::vector<BearingSample> often;
  for (std::size_t i = 0; i < kSequences; ++i) {
    const double angle = 2 * M_PI * random.uniform();
    const double radius = std::sqrt(-2 * std::log(1 - random.uniform()));
    const BearingSample sample{i, 1, 0, 2 * radius * std::cos(angle), 2 * radius * std::sin(angle)};
    once.push_back(sample);
    often.insert(often.end(), 20, sample);
  }
  const double z = 1.959963984540054;
  for (const std::vector<BearingSample>& samples : {once, often}) {
    const auto error = bearing_error(samples);
    for (const Spread* spread : {&error->azimuth, &error->elevation}) {
      const auto half = [](const evaluation::Interval& one) { return (one.high - one.low) / 2; };
      EXPECT_NEAR(half(*spread->mean_interval), z * 2 / std::sqrt(kSequences), 0.03);
      EXPECT_NEAR(half(*spread->deviation_interval), z * 2 / std::sqrt(2 * kSequences), 0.025);
      EXPECT_LT(spread->rms_interval->low, spread->rms);
      EXPECT_GT(spread->rms_interval->high, spread->rms);
      EXPECT_LT(spread->within_95_interval->low, spread->within_95);
      EXPECT_GT(spread->within_95_interval->high, spread->within_95);
    }
  }
}

// Every quantity of a draw is that of the sample with the drawn sequences written out.
TEST(BearingError, RatesHaveIntervalsToo) {
  std::vector<BearingSample> samples;
  for (std::size_t sequence = 0; sequence < 2; ++sequence)
    for (int second = 0; second < 2; ++second)
      samples.push_back({sequence, 1, double(second), second * (sequence == 0 ? 1.0 : 3.0), 0});
  const auto error = bearing_error(samples);
  ASSERT_TRUE(error->azimuth_rate);
  ASSERT_TRUE(error->azimuth_rate->mean_interval);
  EXPECT_NEAR(error->azimuth_rate->mean_interval->low, 1, 1e-12);
  EXPECT_NEAR(error->azimuth_rate->mean_interval->high, 3, 1e-12);
}

}  // namespace
}  // namespace airtruth::measures
