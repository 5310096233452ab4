// SPDX-License-Identifier: Apache-2.0
#include "encounter/pairing/strata.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/chi_square.h"

namespace airtruth::pairing {
namespace {

TEST(Strata, EachStratumOfEachDimensionHoldsOnePoint) {
  for (const std::uint64_t count : {1, 2, 3, 4, 5, 16, 17, 100, 257, 4096, 4097}) {
    const Strata strata(8, count, 5);
    for (std::size_t d = 0; d < 5; ++d) {
      std::vector<int> points(count, 0);
      for (std::uint64_t i = 0; i < count; ++i) {
        const double at = strata.at(i, d);
        ASSERT_GE(at, 0);
        ASSERT_LT(at, 1);
        ++points[static_cast<std::size_t>(std::floor(at * static_cast<double>(count)))];
      }
      EXPECT_EQ(points, std::vector<int>(count, 1)) << count << " " << d;
    }
  }
}

// Two points among three things: over seeds the middle one has its share, and no thing has both.
TEST(Strata, SpacedPointsFallIntoAllThingsAlike) {
  constexpr int kSeeds = 3000;
  std::vector<int> points(3, 0);
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Strata strata(static_cast<std::uint64_t>(seed), 2, 1);
    std::vector<int> own(3, 0);
    for (std::uint64_t i = 0; i < 2; ++i) {
      const double at = strata.spaced(i, 0);
      ASSERT_GE(at, 0);
      ASSERT_LT(at, 1);
      ++own[static_cast<std::size_t>(std::floor(3 * at))];
    }
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LE(own[k], 1);
      points[k] += own[k];
    }
  }
  const double sigma = std::sqrt(kSeeds * (2.0 / 3) * (1.0 / 3));
  for (const int one : points) EXPECT_NEAR(one, 2 * kSeeds / 3.0, 4 * sigma);
}

TEST(Strata, DimensionsAreIndependent) {
  constexpr std::uint64_t kCount = 10'000;
  const Strata strata(8, kCount, 4);
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = a + 1; b < 4; ++b) {
      std::vector<double> cells(100, 0.0), even(100, 0.01);
      double correlation = 0;
      for (std::uint64_t i = 0; i < kCount; ++i) {
        const double x = strata.at(i, a), y = strata.at(i, b);
        ++cells[static_cast<std::size_t>(10 * std::floor(10 * x) + std::floor(10 * y))];
        correlation += 12 * (x - 0.5) * (y - 0.5) / kCount;
      }
      EXPECT_LT(std::abs(correlation), 4 / std::sqrt(double(kCount))) << a << " " << b;
      test_support::ChiSquare chi;
      chi.add(cells, even);
      // The rows and columns are exact, so that 81 of the 99 degrees are free.
      chi.degrees = 81;
      EXPECT_LT(chi.normal_deviate(), test_support::kLevel0001) << a << " " << b;
    }
}

TEST(Strata, OrderSaysNothing) {
  constexpr std::uint64_t kCount = 10'000;
  const Strata strata(1, kCount, 1);
  double correlation = 0;
  for (std::uint64_t i = 0; i + 1 < kCount; ++i)
    correlation += 12 * (strata.at(i, 0) - 0.5) * (strata.at(i + 1, 0) - 0.5) / kCount;
  EXPECT_LT(std::abs(correlation), 4 / std::sqrt(double(kCount)));
}

TEST(Strata, SeedsDiffer) {
  const Strata a(1, 100, 1), b(2, 100, 1);
  int same = 0;
  for (std::uint64_t i = 0; i < 100; ++i) same += a.stratum(i, 0) == b.stratum(i, 0) ? 1 : 0;
  EXPECT_LT(same, 10);
}

}  // namespace
}  // namespace airtruth::pairing
