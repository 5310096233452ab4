// SPDX-License-Identifier: Apache-2.0
#include "tracking/classifier.h"

#include <algorithm>
#include <cmath>

namespace airtruth::tracking {
namespace {

// Of means of grey levels; below it a Gaussian is a spike that nothing fits.
constexpr float kLeastVariance = 0.25f;
// Log-ratios beyond this saturate every probability, and what is learned becomes arbitrary.
constexpr float kMostRatio = 11.5f;

float sigmoid(float z) { return 1 / (1 + std::exp(-z)); }

// ln N(f; object) - ln N(f; surroundings), equal priors.
template <typename Gaussian>
float log_ratio(float f, const Gaussian& object, const Gaussian& around) {
  const float a = f - object.mean;
  const float b = f - around.mean;
  const float h = -a * a / (2 * object.variance) + b * b / (2 * around.variance) -
                  0.5f * std::log(object.variance / around.variance);
  return std::clamp(h, -kMostRatio, kMostRatio);
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

float Classifier::feature(const Weak& weak, const Pyramid& pyramid, const Place& place) const {
  float value = 0;
  for (const Rectangle& r : weak.rectangles)
    value += r.weight * pyramid.sum(level_, place.x + r.x, place.y + r.y, r.width, r.height);
  return value * unit_;
}

float Classifier::score(const Pyramid& pyramid, const Place& place) const {
  float sum = 0;
  for (const std::size_t k : selected_) {
    const Weak& weak = pool_[k];
    sum += log_ratio(feature(weak, pyramid, place), weak.object, weak.surroundings);
  }
  return sum;
}

Classifier::Matrix Classifier::features(const Pyramid& pyramid,
                                        std::span<const Place> places) const {
  Matrix values(pool_.size(), std::vector<float>(places.size()));
  for (std::size_t k = 0; k < pool_.size(); ++k)
    for (std::size_t i = 0; i < places.size(); ++i)
      values[k][i] = feature(pool_[k], pyramid, places[i]);
  return values;
}

// Zhang and Song 2013, eq. 7: the variance before the mean, for it needs the old one.
void Classifier::move(Gaussian& gaussian, const std::vector<float>& values) const {
  double sum = 0;
  double squares = 0;
  for (const float v : values) {
    sum += v;
    squares += double{v} * v;
  }
  const double n = static_cast<double>(values.size());
  const double mean = sum / n;
  const double variance = std::max(0.0, squares / n - mean * mean);
  const double keep = is_first_ ? 0 : options_.memory;
  const double off = gaussian.mean - mean;
  gaussian.variance = std::max(kLeastVariance,
                               static_cast<float>(keep * gaussian.variance + (1 - keep) * variance +
                                                  keep * (1 - keep) * off * off));
  gaussian.mean = static_cast<float>(keep * gaussian.mean + (1 - keep) * mean);
}

void Classifier::learn(const Pyramid& pyramid,
                       std::span<const Place> positives,
                       std::span<const float> distance_px,
                       std::span<const Place> negatives) {
  if (positives.empty() || negatives.empty()) return;
  Matrix object = features(pyramid, positives);
  Matrix around = features(pyramid, negatives);
  for (std::size_t k = 0; k < pool_.size(); ++k) {
    move(pool_[k].object, object[k]);
    move(pool_[k].surroundings, around[k]);
    for (float& f : object[k]) f = log_ratio(f, pool_[k].object, pool_[k].surroundings);
    for (float& f : around[k]) f = log_ratio(f, pool_[k].object, pool_[k].surroundings);
  }
  is_first_ = false;
  selected_.clear();
  if (!options_.weighted) return select_noisy_or(object, around);
  std::vector<float> weights;
  for (const float d : distance_px) weights.push_back(std::exp(-d));
  select_weighted(object, weights, around);
}

// From here on the matrices hold log-ratios.
void Classifier::select_weighted(const Matrix& object,
                                 std::span<const float> weights,
                                 const Matrix& around) {
  std::vector<float> strong_object(object.front().size(), 0);
  std::vector<float> strong_around(around.front().size(), 0);
  std::vector<float> slope_object(strong_object.size());
  std::vector<float> slope_around(strong_around.size());
  std::vector<bool> taken(pool_.size(), false);
  for (int round = 0; round < std::min<int>(options_.selected, static_cast<int>(pool_.size()));
       ++round) {
    float bag = 0;
    float outside = 0;
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
    bag = std::max(bag, 1e-12f);
    outside = std::max(outside, 1e-12f);
    std::size_t best = 0;
    float best_gain = -INFINITY;
    for (std::size_t k = 0; k < pool_.size(); ++k) {
      if (taken[k]) continue;
      float gain_object = 0;
      float gain_around = 0;
      for (std::size_t j = 0; j < slope_object.size(); ++j)
        gain_object += slope_object[j] * object[k][j];
      for (std::size_t j = 0; j < slope_around.size(); ++j)
        gain_around += slope_around[j] * around[k][j];
      const float gain = gain_object / bag - gain_around / outside;
      if (gain > best_gain) {
        best_gain = gain;
        best = k;
      }
    }
    taken[best] = true;
    selected_.push_back(best);
    for (std::size_t j = 0; j < strong_object.size(); ++j) strong_object[j] += object[best][j];
    for (std::size_t j = 0; j < strong_around.size(); ++j) strong_around[j] += around[best][j];
  }
}

// Babenko et al. 2011, algorithm 2: one positive bag by noisy-OR, each negative a bag of its own.
void Classifier::select_noisy_or(const Matrix& object, const Matrix& around) {
  std::vector<float> strong_object(object.front().size(), 0);
  std::vector<float> strong_around(around.front().size(), 0);
  std::vector<bool> taken(pool_.size(), false);
  for (int round = 0; round < std::min<int>(options_.selected, static_cast<int>(pool_.size()));
       ++round) {
    std::size_t best = 0;
    double least = INFINITY;
    for (std::size_t k = 0; k < pool_.size(); ++k) {
      if (taken[k]) continue;
      double none = 1;
      for (std::size_t j = 0; j < strong_object.size(); ++j)
        none *= 1 - sigmoid(strong_object[j] + object[k][j]);
      double cost = -std::log(1 - none + 1e-5) / static_cast<double>(strong_object.size());
      double outside = 0;
      for (std::size_t j = 0; j < strong_around.size(); ++j)
        outside -= std::log(1 - sigmoid(strong_around[j] + around[k][j]) + 1e-5f);
      cost += outside / static_cast<double>(strong_around.size());
      if (cost < least) {
        least = cost;
        best = k;
      }
    }
    taken[best] = true;
    selected_.push_back(best);
    for (std::size_t j = 0; j < strong_object.size(); ++j) strong_object[j] += object[best][j];
    for (std::size_t j = 0; j < strong_around.size(); ++j) strong_around[j] += around[best][j];
  }
}

}  // namespace airtruth::tracking
