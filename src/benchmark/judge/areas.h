// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

// Areas under the curve of a classifier, the judge, and statistics of a mean over clips.
namespace airtruth::judge {

// A value with its 95 % interval by bootstrap over the clips.
struct Interval {
  double value = 0, low = 0, high = 0;
};

// Patches of one clip in the order of their frames: the features that the judge reads, and whether
// the patch shows the real aircraft.
struct Patches {
  std::string name;
  std::vector<std::vector<float>> features;
  std::vector<int> real;            // 1: real, 0: inserted
  std::vector<std::int64_t> frame;  // one number for both of a pair
};

// Returns the probability that a real patch scores higher than an inserted one (Mann and Whitney
// 1947); 0.5 where either kind is missing.
double area_under_curve(const std::vector<double>& scores, const std::vector<int>& real);

// Returns max(area, 1 - area), because a judge that is always wrong separates the two kinds as well
// as one that is always right.
double folded(double area);

// Trains boosted trees (OpenCV's ml) on `train`, applies them to `asked` and returns their area
// under the curve.
double area_of_judge(const std::vector<Patches>& train, const Patches& asked);

// Splits the clip into `folds` stretches of equal length, applies to each a judge trained on the
// others, and returns the mean of the folded areas. Both patches of a pair stay in one stretch.
// Returns 0.5 where the clip holds fewer than four pairs per stretch.
double area_within(const Patches& clip, int folds);

// The mean (or median) of values, one per clip, with its 95 % interval by bootstrap over the clips
// (Efron 1979; 2,000 draws). The same seed gives the same interval.
Interval mean_over_clips(const std::vector<double>& values, std::uint64_t seed);
Interval median_over_clips(const std::vector<double>& values, std::uint64_t seed);

}  // namespace airtruth::judge
