// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "foundation/base/seed.h"
#include "runners/tracking/luma_window.h"

namespace airtruth::tracking {

struct Am3Options {
  std::uint64_t seed = 1;
  // In pixels of full resolution.
  int search_radius_px = 40;
  int levels = 3;  // upper bound; small objects use fewer
  int voters = 3;  // number of classifiers at each level
  // Number of weak classifiers that learn.
  int pool = 250;
  // Number of these that are selected to decide.
  int selected = 20;
  // Weight of the previous value when a Gaussian is updated.
  double memory = 0.93;
  // Windows nearer to the object than this distance, and than this share of the object's shorter
  // side, are positives.
  double positive_radius_px = 4;
  double positive_share = 0.25;
  // Gap between the positives and the nearest negatives, after the first frame.
  double gap_px = 2;
  int negatives = 50;
  // Number of further negatives: the windows that looked most like the object.
  int hard = 50;
  bool weighted = true;
  bool follows_scale = false;  // false: the box keeps its first size
};

// Top-left corner of a window at one level of a pyramid, in that level's pixels.
struct Place {
  int x = 0;
  int y = 0;
  bool operator==(const Place&) const = default;
};

// A boosted classifier for windows of one size at one level. It has a pool of Haar-like features,
// each with a Gaussian for the object and one for the surroundings, and a selection of a few of
// them (am3.cpp has the sources).
class Classifier {
 public:
  Classifier(const Am3Options& options, int level, int width, int height, Random random);

  // Returns the sum of the selected weak classifiers at each place; a positive sum means the
  // object. Windows must lie in the pyramid's part of the picture.
  std::vector<float> scores(const Pyramid& pyramid, std::span<const Place> places) const;

  // `distance_px[i]` is the distance of positives[i] from the object in pixels of full resolution.
  void learn(const Pyramid& pyramid,
             std::span<const Place> positives,
             std::span<const float> distance_px,
             std::span<const Place> negatives);

 private:
  struct Rectangle {
    int x = 0, y = 0, width = 0, height = 0;
    float weight = 0;  // divided by its area
  };
  struct Gaussian {
    float mean = 0;
    float variance = 1;
  };
  struct Weak {
    std::vector<Rectangle> rectangles;
    Gaussian object, surroundings;
  };
  // A table with one number for each weak classifier of the pool and each sample.
  class Matrix {
   public:
    Matrix(std::size_t pool, std::size_t samples) : samples_(samples), values_(pool * samples) {}
    std::size_t samples() const { return samples_; }
    std::span<float> row(std::size_t weak) { return {&values_[weak * samples_], samples_}; }
    std::span<const float> row(std::size_t weak) const {
      return {&values_[weak * samples_], samples_};
    }

   private:
    std::size_t samples_;
    std::vector<float> values_;
  };

  void add_feature(const Weak& weak,
                   const Pyramid& pyramid,
                   std::span<const std::ptrdiff_t> bases,
                   std::span<float> values) const;
  std::vector<std::ptrdiff_t> bases_of(const Pyramid& pyramid, std::span<const Place> places) const;
  Matrix features(const Pyramid& pyramid, std::span<const Place> places) const;
  void move(std::size_t weak, const Matrix& object, const Matrix& around);
  void to_ratios(Matrix& values) const;
  void select(const Matrix& object, const Matrix& around, const auto& gains_of_round);
  void select_weighted(const Matrix& object, std::span<const float> weights, const Matrix& around);
  void select_noisy_or(const Matrix& object, const Matrix& around);

  Am3Options options_;
  int level_;
  // Unit of the pyramid's sums at this level.
  float unit_;
  std::vector<Weak> pool_;
  std::vector<std::size_t> selected_;
  bool is_first_ = true;
};

}  // namespace airtruth::tracking
