// SPDX-License-Identifier: Apache-2.0
#include "detection/scoring/average_precision.h"

#include <algorithm>
#include <numeric>

#include "detection/scoring/cluster_draws.h"
#include "detection/scoring/ranking.h"

namespace airtruth::detection {
namespace {

constexpr int kOverlapSteps = 10;

// As numpy.linspace(0.5, 0.95, 10), which cocoeval.py uses.
double overlap_step(int i) {
  return i == kOverlapSteps - 1 ? 0.95 : i * ((0.95 - 0.5) / (kOverlapSteps - 1)) + 0.5;
}

struct MeanScores {
  std::optional<double> precision, recall;
  std::optional<double> precision_50, precision_75;
};

// Means over the overlaps.
MeanScores means_of(std::span<const ImageList> sequences, const AreaRange& areas, int most) {
  MeanScores means;
  double precision = 0;
  double recall = 0;
  for (int i = 0; i < kOverlapSteps; ++i) {
    const auto curve =
        curve_of(ranking_of(sequences, {Likeness::kOverlap, overlap_step(i), areas, most}));
    if (!curve) return means;
    precision += curve->average_precision;
    recall += curve->recall;
    if (i == 0) means.precision_50 = curve->average_precision;
    if (i == 5) means.precision_75 = curve->average_precision;
  }
  means.precision = precision / kOverlapSteps;
  means.recall = recall / kOverlapSteps;
  return means;
}

// Curves of sequences that are drawn with replacement.
std::vector<PrecisionCurve> drawn_curves(const Ranking& ranking) {
  std::vector<PrecisionCurve> curves;
  const std::size_t sequences = ranking.truths.size();
  if (sequences < 2) return curves;
  const std::size_t draws = draws_for(ranking.detections.size());
  ClusterDraws drawn(sequences, "average precision");
  for (std::size_t draw = 0; draw < draws; ++draw) {
    const std::span<const double> counts = drawn.next();
    double truths = 0;
    for (std::size_t i = 0; i < sequences; ++i)
      truths += counts[i] * static_cast<double>(ranking.truths[i]);
    if (truths > 0) curves.push_back(curve_of(ranking, counts));
  }
  return curves;
}

struct Curves {
  std::optional<PrecisionCurve> curve;
  std::optional<PrecisionBand> band;
  std::optional<evaluation::Interval> interval;
};

Curves curves_of(std::span<const ImageList> sequences, Likeness likeness, double threshold) {
  const Ranking ranking = ranking_of(sequences, {likeness, threshold, kAllAreas, 100});
  Curves result;
  result.curve = curve_of(ranking);
  const std::vector<PrecisionCurve> drawn =
      result.curve ? drawn_curves(ranking) : std::vector<PrecisionCurve>{};
  if (drawn.size() < 2) return result;
  std::vector<double> values(drawn.size());
  std::transform(drawn.begin(), drawn.end(), values.begin(), [](const PrecisionCurve& curve) {
    return curve.average_precision;
  });
  result.interval = percentile_interval(values);
  result.band.emplace();
  for (std::size_t i = 0; i < kRecallSteps; ++i) {
    std::transform(drawn.begin(), drawn.end(), values.begin(), [i](const PrecisionCurve& curve) {
      return curve.precision[i];
    });
    const evaluation::Interval limits = percentile_interval(values);
    result.band->low[i] = limits.low;
    result.band->high[i] = limits.high;
  }
  return result;
}

}  // namespace

std::optional<PrecisionCurve> precision_curve(std::span<const ScoredImage> images,
                                              const PrecisionOptions& options) {
  return curve_of(ranking_of(std::vector<ImageList>{images}, options));
}

AveragePrecision average_precision(std::span<const std::vector<ScoredImage>> sequences,
                                   double centre_px) {
  const std::vector<ImageList> lists(sequences.begin(), sequences.end());
  AveragePrecision result;
  const MeanScores all = means_of(lists, kAllAreas, 100);
  result.ap = all.precision;
  result.ap_50 = all.precision_50;
  result.ap_75 = all.precision_75;
  result.ar_100 = all.recall;
  result.ar_1 = means_of(lists, kAllAreas, 1).recall;
  result.ar_10 = means_of(lists, kAllAreas, 10).recall;
  const MeanScores small = means_of(lists, kSmall, 100);
  result.ap_small = small.precision;
  result.ar_small = small.recall;
  const MeanScores medium = means_of(lists, kMedium, 100);
  result.ap_medium = medium.precision;
  result.ar_medium = medium.recall;
  const MeanScores large = means_of(lists, kLarge, 100);
  result.ap_large = large.precision;
  result.ar_large = large.recall;
  Curves overlap = curves_of(lists, Likeness::kOverlap, 0.5);
  result.curve_50 = overlap.curve;
  result.band_50 = overlap.band;
  result.ap_50_interval = overlap.interval;
  Curves centre = curves_of(lists, Likeness::kCentre, centre_px);
  if (centre.curve) result.ap_centre = centre.curve->average_precision;
  result.curve_centre = centre.curve;
  result.band_centre = centre.band;
  result.ap_centre_interval = centre.interval;
  return result;
}

}  // namespace airtruth::detection
