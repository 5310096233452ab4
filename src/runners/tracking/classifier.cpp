// SPDX-License-Identifier: Apache-2.0
#include "runners/tracking/classifier.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace airtruth::tracking {
namespace {

// Variance of means of grey levels, squared levels; below it a Gaussian is a spike that nothing
// fits.
constexpr float kMinVariance = 0.25f;
// Natural logarithm: larger log-ratios saturate every probability, and the learned values become
// arbitrary.
constexpr float kMaxRatio = 11.5f;

float sigmoid(float z) { return 1 / (1 + std::exp(-z)); }

// ln N(f; object) - ln N(f; surroundings), equal priors, as a quadratic of f.
class Ratio {
 public:
  template <typename Gaussian>
  Ratio(const Gaussian& object, const Gaussian& around)
      : mean_object_(object.mean),
        mean_around_(around.mean),
        object_(-1 / (2 * object.variance)),
        around_(1 / (2 * around.variance)),
        constant_(-0.5f * std::log(object.variance / around.variance)) {}
  float operator()(float f) const {
    const float a = f - mean_object_;
    const float b = f - mean_around_;
    return std::clamp(a * a * object_ + b * b * around_ + constant_, -kMaxRatio, kMaxRatio);
  }

 private:
  float mean_object_, mean_around_, object_, around_, constant_;
};

// Eight sums run side by side, because a single sum would be added in order, one number at a time.
float dot(std::span<const float> a, std::span<const float> b) {
  // Number of sums: 8 floats are a vector of 256 bits.
  constexpr std::size_t kSums = 8;
  std::array<float, kSums> sums{};
  std::size_t i = 0;
  for (; i + kSums <= a.size(); i += kSums)
    for (std::size_t k = 0; k < kSums; ++k) sums[k] += a[i + k] * b[i + k];
  float sum = 0;
  for (; i < a.size(); ++i) sum += a[i] * b[i];
  for (const float s : sums) sum += s;
  return sum;
}

void add(std::span<const float> values, std::vector<float>& to) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += values[i];
}

int below(Random& random, int count) {
  return std::min(count - 1, static_cast<int>(random.uniform() * count));
}

}  // namespace

Classifier::Classifier(const Am3Options& options, int level, int width, int height, Random random)
    : options_(options), level_(level), unit_(1.0f / static_cast<float>(1 << (2 * level))) {
  pool_.resize(static_cast<std::size_t>(options.pool));
  for (Weak& weak : pool_) {
    const int count = 2 + below(random, 2);
    for (int i = 0; i < count; ++i) {
      Rectangle r;
      r.x = below(random, std::max(1, width - 2));
      r.y = below(random, std::max(1, height - 2));
      r.width = 1 + below(random, std::max(1, width - r.x - 1));
      r.height = 1 + below(random, std::max(1, height - r.y - 1));
      r.weight = static_cast<float>(random.uniform(-1, 1)) / static_cast<float>(r.width * r.height);
      weak.rectangles.push_back(r);
    }
  }
}

std::vector<std::ptrdiff_t> Classifier::bases_of(const Pyramid& pyramid,
                                                 std::span<const Place> places) const {
  std::vector<std::ptrdiff_t> bases;
  bases.reserve(places.size());
  for (const Place& place : places) bases.push_back(pyramid.offset(level_, place.x, place.y));
  return bases;
}

// Adds a weak classifier's feature of each window to what is in `values`.
void Classifier::add_feature(const Weak& weak,
                             const Pyramid& pyramid,
                             std::span<const std::ptrdiff_t> bases,
                             std::span<float> values) const {
  for (const Rectangle& r : weak.rectangles) {
    const std::uint32_t* above = pyramid.sums() + pyramid.offset(level_, r.x, r.y);
    const std::uint32_t* below = above + pyramid.offset(level_, 0, r.height);
    const std::ptrdiff_t right = pyramid.offset(level_, r.width, 0);
    const float weight = r.weight * unit_;
    for (std::size_t i = 0; i < bases.size(); ++i) {
      const std::ptrdiff_t at = bases[i];
      // The arithmetic wraps modulo 2^32 like the sums, and the difference is right.
      const std::uint32_t sum = below[at + right] - below[at] - above[at + right] + above[at];
      values[i] += weight * static_cast<float>(sum);
    }
  }
}

std::vector<float> Classifier::scores(const Pyramid& pyramid, std::span<const Place> places) const {
  const std::vector<std::ptrdiff_t> bases = bases_of(pyramid, places);
  std::vector<float> scores(places.size(), 0);
  std::vector<float> values(places.size());
  for (const std::size_t k : selected_) {
    std::fill(values.begin(), values.end(), 0.0f);
    add_feature(pool_[k], pyramid, bases, values);
    const Ratio ratio(pool_[k].object, pool_[k].surroundings);
    for (std::size_t i = 0; i < values.size(); ++i) scores[i] += ratio(values[i]);
  }
  return scores;
}

Classifier::Matrix Classifier::features(const Pyramid& pyramid,
                                        std::span<const Place> places) const {
  const std::vector<std::ptrdiff_t> bases = bases_of(pyramid, places);
  Matrix matrix(pool_.size(), places.size());
  for (std::size_t k = 0; k < pool_.size(); ++k)
    add_feature(pool_[k], pyramid, bases, matrix.row(k));
  return matrix;
}

// Zhang and Song 2013, eq. 7: the variance before the mean, for it needs the old one.
void Classifier::move(std::size_t weak, const Matrix& object, const Matrix& around) {
  const auto moved = [&](Gaussian& gaussian, const Matrix& values) {
    double sum = 0;
    double squares = 0;
    for (const float v : values.row(weak)) {
      sum += v;
      squares += double{v} * v;
    }
    const double n = static_cast<double>(values.samples());
    const double mean = sum / n;
    const double variance = std::max(0.0, squares / n - mean * mean);
    const double keep = is_first_ ? 0 : options_.memory;
    const double off = gaussian.mean - mean;
    gaussian.variance =
        std::max(kMinVariance,
                 static_cast<float>(keep * gaussian.variance + (1 - keep) * variance +
                                    keep * (1 - keep) * off * off));
    gaussian.mean = static_cast<float>(keep * gaussian.mean + (1 - keep) * mean);
  };
  moved(pool_[weak].object, object);
  moved(pool_[weak].surroundings, around);
}

void Classifier::to_ratios(Matrix& values) const {
  for (std::size_t k = 0; k < pool_.size(); ++k) {
    const Ratio ratio(pool_[k].object, pool_[k].surroundings);
    for (float& value : values.row(k)) value = ratio(value);
  }
}

void Classifier::learn(const Pyramid& pyramid,
                       std::span<const Place> positives,
                       std::span<const float> distance_px,
                       std::span<const Place> negatives) {
  if (positives.empty() || negatives.empty()) return;
  Matrix object = features(pyramid, positives);
  Matrix around = features(pyramid, negatives);
  for (std::size_t k = 0; k < pool_.size(); ++k) move(k, object, around);
  to_ratios(object);
  to_ratios(around);
  is_first_ = false;
  selected_.clear();
  if (!options_.weighted) return select_noisy_or(object, around);
  std::vector<float> weights;
  for (const float d : distance_px) weights.push_back(std::exp(-d));
  select_weighted(object, weights, around);
}

// From here on the matrices hold log-ratios.

// Selects one weak classifier after another: in each round that with the greatest gain. What is
// selected so far says `strong_object` and `strong_around` of the samples;
// gains_of_round(strong_object, strong_around) returns the gain of each weak classifier.
void Classifier::select(const Matrix& object, const Matrix& around, const auto& gains_of_round) {
  std::vector<float> strong_object(object.samples(), 0);
  std::vector<float> strong_around(around.samples(), 0);
  std::vector<bool> taken(pool_.size(), false);
  const int rounds = std::min(options_.selected, static_cast<int>(pool_.size()));
  for (int round = 0; round < rounds; ++round) {
    const auto gain_of = gains_of_round(strong_object, strong_around);
    std::size_t best = 0;
    double most = -INFINITY;
    for (std::size_t k = 0; k < pool_.size(); ++k) {
      if (taken[k]) continue;
      const double gain = gain_of(k);
      if (gain > most) {
        most = gain;
        best = k;
      }
    }
    taken[best] = true;
    selected_.push_back(best);
    add(object.row(best), strong_object);
    add(around.row(best), strong_around);
  }
}

void Classifier::select_weighted(const Matrix& object,
                                 std::span<const float> weights,
                                 const Matrix& around) {
  std::vector<float> slope_object(object.samples());
  std::vector<float> slope_around(around.samples());
  select(object, around, [&](const auto& strong_object, const auto& strong_around) {
    float bag = 1e-12f;
    float outside = 1e-12f;
    for (std::size_t j = 0; j < strong_object.size(); ++j) {
      const float s = sigmoid(strong_object[j]);
      slope_object[j] = weights[j] * s * (1 - s);
      bag += weights[j] * s;
    }
    for (std::size_t j = 0; j < strong_around.size(); ++j) {
      const float t = sigmoid(strong_around[j]);
      slope_around[j] = t * (1 - t);
      outside += 1 - t;
    }
    return [&, bag, outside](std::size_t k) {
      return dot(object.row(k), slope_object) / bag - dot(around.row(k), slope_around) / outside;
    };
  });
}

// Babenko et al. 2011, algorithm 2: one positive bag by noisy-OR, each negative a bag of its own.
void Classifier::select_noisy_or(const Matrix& object, const Matrix& around) {
  select(object, around, [&](const auto& strong_object, const auto& strong_around) {
    return [&](std::size_t k) {
      const std::span<const float> inside = object.row(k);
      const std::span<const float> beside = around.row(k);
      double none = 1;
      for (std::size_t j = 0; j < strong_object.size(); ++j)
        none *= 1 - sigmoid(strong_object[j] + inside[j]);
      const double gain = std::log(1 - none + 1e-5) / static_cast<double>(strong_object.size());
      double outside = 0;
      for (std::size_t j = 0; j < strong_around.size(); ++j)
        outside -= std::log(1 - sigmoid(strong_around[j] + beside[j]) + 1e-5f);
      return gain - outside / static_cast<double>(strong_around.size());
    };
  });
}

}  // namespace airtruth::tracking
