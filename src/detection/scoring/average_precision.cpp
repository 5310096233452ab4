// SPDX-License-Identifier: Apache-2.0
#include "detection/scoring/average_precision.h"

#include <algorithm>
#include <numeric>

#include "detection/scoring/ranking.h"
#include "foundation/base/seed.h"

namespace airtruth::detection {
namespace {

constexpr int kOverlapSteps = 10;
constexpr std::size_t kDraws = 1000;
// Draws times detections, about 2 s on one core; results with more detections have fewer draws, but
// no less than kFewestDraws.
constexpr std::size_t kMostWork = 400'000'000;
constexpr std::size_t kFewestDraws = 200;

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

// Interpolates between the two nearest of the sorted values (Hyndman and Fan 1996, type 7).
evaluation::Interval percentiles(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    const double position = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(position);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] +
           (position - static_cast<double>(below)) * (values[above] - values[below]);
  };
  return {at(0.025), at(0.975)};
}

// Curves of sequences that are drawn with replacement.
std::vector<PrecisionCurve> drawn_curves(const Ranking& ranking) {
  std::vector<PrecisionCurve> curves;
  const std::size_t sequences = ranking.truths.size();
  if (sequences < 2) return curves;
  const std::size_t draws = std::clamp(
      kMostWork / std::max<std::size_t>(1, ranking.detections.size()), kFewestDraws, kDraws);
  Random random = Seed(1).stream("average precision");
  std::vector<double> weights(sequences);
  for (std::size_t draw = 0; draw < draws; ++draw) {
    std::fill(weights.begin(), weights.end(), 0.0);
    std::int64_t truths = 0;
    for (std::size_t i = 0; i < sequences; ++i) {
      const std::size_t k =
          std::min(sequences - 1,
                   static_cast<std::size_t>(random.uniform() * static_cast<double>(sequences)));
      weights[k] += 1;
      truths += ranking.truths[k];
    }
    if (truths > 0) curves.push_back(curve_of(ranking, weights));
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
  result.interval = percentiles(values);
  result.band.emplace();
  for (std::size_t i = 0; i < kRecallSteps; ++i) {
    std::transform(drawn.begin(), drawn.end(), values.begin(), [i](const PrecisionCurve& curve) {
      return curve.precision[i];
    });
    const evaluation::Interval limits = percentiles(values);
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
