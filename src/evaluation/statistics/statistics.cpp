// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <airtruth/statistics.h>

#include "evaluation/statistics/bootstrap.h"
#include "foundation/base/error.h"
#include "foundation/base/seed.h"

namespace airtruth::evaluation {
namespace {

constexpr int kDraws = 10'000;         // an end of an interval is certain to 1 % of its width
constexpr int kSignDraws = 20'000;     // a p of 0.05 is certain to 0.0015
constexpr std::size_t kMaxExact = 16;  // differences, whose 65,536 sign changes are all tried

// The share of sign changes of the differences whose sum is at least as far from 0 as the observed
// one.
double sign_test(const std::vector<double>& differences) {
  double sum = 0;
  double size = 0;
  for (const double d : differences) {
    sum += d;
    size += std::abs(d);
  }
  // Sums of the same numbers in another order differ in their last digits.
  const double wanted = std::abs(sum) - 1e-12 * size;
  const std::size_t n = differences.size();
  std::int64_t as_far = 0;
  if (n <= kMaxExact) {
    const std::uint32_t all = std::uint32_t{1} << n;
    for (std::uint32_t signs = 0; signs < all; ++signs) {
      double changed = 0;
      for (std::size_t i = 0; i < n; ++i)
        changed += (signs >> i & 1) != 0 ? -differences[i] : differences[i];
      as_far += std::abs(changed) >= wanted ? 1 : 0;
    }
    return static_cast<double>(as_far) / all;
  }
  Random random = Seed(1).stream("signs");
  for (int draw = 0; draw < kSignDraws; ++draw) {
    double changed = 0;
    for (const double d : differences) changed += random.uniform() < 0.5 ? -d : d;
    as_far += std::abs(changed) >= wanted ? 1 : 0;
  }
  // The observed signs count as one of the sign changes.
  return static_cast<double>(as_far + 1) / (kSignDraws + 1);
}

void expect_pairs(std::span<const double> a, std::span<const double> b) {
  if (a.size() != b.size()) throw Error("the two lists of values are not of one length");
}

}  // namespace

std::optional<Interval> bootstrap_mean(std::span<const double> values,
                                       std::span<const double> weights) {
  if (!weights.empty() && weights.size() != values.size())
    throw Error("there are not as many weights as values");
  if (values.size() < 2) return std::nullopt;
  Random random = Seed(1).stream("bootstrap");
  std::vector<double> means;
  means.reserve(kDraws);
  const double n = static_cast<double>(values.size());
  for (int draw = 0; draw < kDraws; ++draw) {
    double sum = 0;
    double weight = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t k =
          std::min(values.size() - 1, static_cast<std::size_t>(random.uniform() * n));
      const double w = weights.empty() ? 1 : weights[k];
      sum += w * values[k];
      weight += w;
    }
    if (weight > 0) means.push_back(sum / weight);
  }
  if (means.empty()) return std::nullopt;
  return statistics::percentile_interval(std::move(means));
}

Paired paired(std::span<const double> a, std::span<const double> b) {
  expect_pairs(a, b);
  Paired result;
  std::vector<double> differences;
  for (std::size_t i = 0; i < a.size(); ++i) {
    differences.push_back(a[i] - b[i]);
    result.difference += differences.back();
    result.wins += a[i] > b[i] ? 1 : 0;
    result.losses += a[i] < b[i] ? 1 : 0;
    result.ties += a[i] == b[i] ? 1 : 0;
  }
  if (differences.empty()) return result;
  result.difference /= static_cast<double>(differences.size());
  result.interval = bootstrap_mean(differences);
  result.p_value = sign_test(differences);
  return result;
}

std::optional<double> kendall_tau(std::span<const double> a, std::span<const double> b) {
  expect_pairs(a, b);
  const auto sign = [](double v) { return (v > 0) - (v < 0); };
  std::int64_t agree = 0;
  // Number of pairs that are not tied.
  std::int64_t in_a = 0;
  std::int64_t in_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = i + 1; j < a.size(); ++j) {
      const int x = sign(a[i] - a[j]);
      const int y = sign(b[i] - b[j]);
      agree += x * y;
      in_a += x != 0 ? 1 : 0;
      in_b += y != 0 ? 1 : 0;
    }
  if (in_a == 0 || in_b == 0) return std::nullopt;
  return static_cast<double>(agree) /
         std::sqrt(static_cast<double>(in_a) * static_cast<double>(in_b));
}

}  // namespace airtruth::evaluation
