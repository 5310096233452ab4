// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

// Measures whether a classifier, the judge, distinguishes real aircraft from inserted ones by their
// patches in the comparisons of several clips (the paper, section II.D).
namespace airtruth::judge {

namespace fs = std::filesystem;

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

// A measure over all clips: the medians of the clips' values and of the differences (inserted minus
// real). Clips without the measure are left out.
struct Gap {
  std::string name;
  std::size_t clips = 0;
  double real = 0, made = 0;
  Interval difference;
};

// The judge's result. The judge is boosted trees (OpenCV's ml) on gradient orientations, noise,
// edges and spectrum of patches. Areas under the curve are folded, max(area, 1 - area), because a
// judge that is always wrong distinguishes the two as well as one that is always right. An area of
// 0.5 means that the judge cannot distinguish them. Where a clip has few pairs, chance alone raises
// a folded area above 0.5.
struct Verdict {
  // Applied to each clip in turn and trained on the others.
  Interval across;
  // Trained and applied within a clip, in stretches of time.
  Interval within;
  struct Clip {
    std::string name;
    std::size_t pairs = 0;
    double across = 0.5;  // not folded
    double within = 0.5;  // folded
  };
  std::vector<Clip> clips;
  // What `across` is where no difference is common to the clips: each clip keeps its own, but which
  // of its two aircraft is called real is drawn for each clip. Clips that differ, whatever in, give
  // folded areas far above 0.5, since a judge finds the side of a clip that happens to look like
  // the others. A judge that finds the inserted aircraft finds more than that.
  struct ByChance {
    int draws = 0;
    double mean = 0, least = 0, most = 0;
    int as_high = 0;  // draws that reach the area found
  };
  std::optional<ByChance> by_chance;
  std::vector<std::pair<std::string, double>>
      telling;  // features, by how well each alone separates
  std::vector<Gap> gaps;
};
// `chance_draws` is the number of draws for by_chance; each takes as long as `across`. 0 means
// none.
Verdict verdict_on(const std::vector<fs::path>& comparisons,
                   std::uint64_t seed,
                   int chance_draws = 0,
                   const std::stop_token& stop = {});

// The verdict as Markdown tables and as JSON.
std::string text_of(const Verdict& verdict);
std::string json_of(const Verdict& verdict);

}  // namespace airtruth::judge
