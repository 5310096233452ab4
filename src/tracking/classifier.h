// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "base/seed.h"
#include "tracking/am3.h"
#include "tracking/pyramid.h"

namespace airtruth::tracking {

// Top-left corner of a window at one level of a pyramid.
struct Place {
  int x = 0;
  int y = 0;
  bool operator==(const Place&) const = default;
};

// One boosted classifier of windows of one size at one level: a pool of Haar-like features with a
// Gaussian each for object and surroundings, and the few that were selected (am3.h has the
// sources).
class Classifier {
 public:
  Classifier(const Am3Options& options, int level, int width, int height, Random random);

  // Sum of the selected weak classifiers: positive where it is the object. Windows must lie in the
  // pyramid's part.
  float score(const Pyramid& pyramid, const Place& place) const;

  // `distance_px[i]`: of positives[i] from the object, in full pixels.
  void learn(const Pyramid& pyramid,
             std::span<const Place> positives,
             std::span<const float> distance_px,
             std::span<const Place> negatives);

 private:
  struct Rectangle {
    int x = 0, y = 0, width = 0, height = 0;
    float weight = 0;  // over its area
  };
  struct Gaussian {
    float mean = 0;
    float variance = 1;
  };
  struct Weak {
    std::vector<Rectangle> rectangles;
    Gaussian object, surroundings;
  };
  using Matrix = std::vector<std::vector<float>>;  // [weak][sample]

  float feature(const Weak& weak, const Pyramid& pyramid, const Place& place) const;
  Matrix features(const Pyramid& pyramid, std::span<const Place> places) const;
  void move(Gaussian& gaussian, const std::vector<float>& values) const;
  void select_weighted(const Matrix& object, std::span<const float> weights, const Matrix& around);
  void select_noisy_or(const Matrix& object, const Matrix& around);

  Am3Options options_;
  int level_;
  float unit_;  // of a pyramid's sums
  std::vector<Weak> pool_;
  std::vector<std::size_t> selected_;
  bool is_first_ = true;
};

}  // namespace airtruth::tracking
