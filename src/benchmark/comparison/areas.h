// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "benchmark/comparison/comparison.h"

// A judge's areas under the curve, and what may be said of a mean over clips.
namespace airtruth::comparison {

// Patches of one clip in the order of their frames: what a judge reads of each, and whether it is
// of the real aircraft.
struct Patches {
  std::string name;
  std::vector<std::vector<float>> features;
  std::vector<int> real;            // 1: real, 0: inserted
  std::vector<std::int64_t> frame;  // one number for both of a pair
};

// The probability that a real one scores higher than an inserted one (Mann and Whitney 1947); 0.5
// where there are none of one kind.
double area_under_curve(const std::vector<double>& scores, const std::vector<int>& real);

// max(area, 1 - area): whoever is wrong every time tells the two apart.
double folded(double area);

// Boosted trees (OpenCV's ml) trained on `train`, asked about `asked`: their area under the curve.
double area_of_judge(const std::vector<Patches>& train, const Patches& asked);

// The clip in `folds` stretches of equal length, each asked about by a judge that is trained on
// the others; the mean of the folded areas. Pairs stay whole. 0.5 where the clip holds fewer than
// four pairs a stretch.
double area_within(const Patches& clip, int folds);

// The mean (or median) of values, one a clip, with its 95 % interval by bootstrap over the clips
// (Efron 1979; 2,000 draws). The same seed gives the same interval.
Interval mean_over_clips(const std::vector<double>& values, std::uint64_t seed);
Interval median_over_clips(const std::vector<double>& values, std::uint64_t seed);

}  // namespace airtruth::comparison
